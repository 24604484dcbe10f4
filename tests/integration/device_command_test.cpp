// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint device info`, and energy, throttling and drift of runs, on made-up files of other machines.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/sysfs_trees.h"

namespace stillpoint {
namespace {

using nlohmann::json;

json json_of(const std::filesystem::path& file) { return json::parse(std::ifstream(file)); }

TEST(DeviceCommand, ShowsWhatIsAvailable) {
  const TemporaryFolder root;
  write_jetpack5(root);
  const ProgramResult result = run_program({"device", "info", "--sysfs-root", root.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* text : {"JetPack 5 (L4T R35.4.1)", "MAXN (0)", "47.03 deg C", "4.96 W", "INA3221"})
    EXPECT_NE(result.out.find(text), std::string::npos) << text << '\n' << result.out;
}

TEST(DeviceCommand, SaysWhatIsNotAvailable) {
  const TemporaryFolder root;
  const ProgramResult result = run_program({"device", "info", "--sysfs-root", root.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* text : {"power rails          unavailable", "energy of runs       unavailable"})
    EXPECT_NE(result.out.find(text), std::string::npos) << text << '\n' << result.out;
}

TEST(DeviceCommand, RejectsAMissingRoot) {
  const ProgramResult result = run_program({"device", "info", "--sysfs-root", "/no/such/folder"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("/no/such/folder: is not a folder"), std::string::npos) << result.err;
}

TEST(RunCommand, MeasuresEnergyWherePowerRailsAreReadable) {
  const TemporaryFolder root, out;
  write_jetpack5(root);
  const ProgramResult result = run_program({"run", rendered_sequence().string(), "--out", out.path().string(),
                                            "--sysfs-root", root.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json scores = json_of(out.path() / "result.json");
  // Power is the same before and during the run: only rounding remains above idle, possibly below 0.
  EXPECT_NEAR(scores.at("power_w").get<double>(), 4.96, 1e-3);
  EXPECT_NEAR(scores.at("idle_power_w").get<double>(), 4.96, 1e-3);
  EXPECT_GE(scores.at("energy_rate_hz"), 10.0);
  EXPECT_EQ(scores.at("throttled"), 0.0);
  EXPECT_EQ(json_of(out.path() / "manifest.json").at("host").at("device").at("nvpmodel"), "MAXN (0)");
}

TEST(RunCommand, HasNoEnergyWithAWrongRail) {
  const TemporaryFolder root, out;
  write_jetpack5(root);
  write_hwmon_rail(root, kHwmonFolder, 1, "VDD_IN", "4960", "-3");
  const ProgramResult result = run_program({"run", rendered_sequence().string(), "--out", out.path().string(),
                                            "--sysfs-root", root.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json scores = json_of(out.path() / "result.json");
  for (const char* name : {"energy_j_per_frame", "energy_j_per_frame_sd", "power_w", "idle_power_w"})
    EXPECT_TRUE(scores.at(name).is_null()) << name;
}

TEST(ProfileCommand, ShowsTheDriftOfRepeatedRuns) {
  const TemporaryFolder root, out;
  write_jetpack5(root);
  const ProgramResult result =
      run_program({"profile", rendered_sequence().string(), "--out", out.path().string(), "--max-frames",
                   "20", "--duration", "0.5s", "--sysfs-root", root.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("temperature 47.0 deg C -> 47.0 deg C"), std::string::npos) << result.out;
  const json drift = json_of(out.path() / "profile.json").at("drift");
  ASSERT_FALSE(drift.empty());
  EXPECT_GE(drift.back().at("t_s"), 0.5);
  EXPECT_GT(drift.back().at("frame_ms"), 0.0);
}

TEST(ProfileCommand, RejectsADurationWithoutUnit) {
  for (const char* duration : {"10", "m", "-1s", "nans", "infs", "10min", "1e9h"}) {
    const ProgramResult result = run_program({"profile", "market", "--duration", duration});
    EXPECT_EQ(result.exit_code, 2) << duration;
    EXPECT_NE(result.err.find("is not a duration"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace stillpoint
