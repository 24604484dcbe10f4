// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint profile`: profile of one run.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/trace_rules.h"

namespace stillpoint {
namespace {

using nlohmann::json;

constexpr int kFrames = 40;

ProgramResult profile(const TemporaryFolder& folder, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"profile",      rendered_sequence().string(),
                                        "--out",        folder.path().string(),
                                        "--max-frames", std::to_string(kFrames)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

json read_json(const std::filesystem::path& file) { return json::parse(std::ifstream(file)); }

json module_of(const json& profile, const std::string& name) {
  for (const json& row : profile.at("modules")) {
    if (row.at("module") == name) return row;
  }
  return nullptr;
}

TEST(ProfileCommand, TimesEveryFrame) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--frame-budget-ms", "0.001"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("tracking_thread"), std::string::npos) << result.out;
  const json profiled = read_json(folder.path() / "profile.json");
  const json tracking = module_of(profiled, "tracking_thread");
  ASSERT_FALSE(tracking.is_null());
  EXPECT_EQ(tracking.at("calls"), kFrames);
  EXPECT_GT(tracking.at("per_frame_ms").at("median").get<double>(), 0.0);
  // The budget of 1 ps is exceeded by all frames.
  EXPECT_EQ(profiled.at("deadline").at("missed_by_a_thread_per_stage"), kFrames);
}

TEST(ProfileCommand, WritesAValidTraceInSequentialAndPipelinedMode) {
  for (const char* mode : {"sequential", "pipelined"}) {
    const TemporaryFolder folder;
    const ProgramResult result = profile(folder, {"--mode", mode});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json trace = read_json(folder.path() / "trace.json");
    EXPECT_EQ(trace_format_errors(trace), std::vector<std::string>{}) << mode;
    int tracked = 0;
    for (const json& event : trace.at("traceEvents")) tracked += event.at("name") == "tracking_thread";
    EXPECT_EQ(tracked, kFrames) << mode;
  }
}

TEST(ProfileCommand, ReportsTheResourceUsageOfTheProcess) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--cores", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json process = read_json(folder.path() / "profile.json").at("process");
  EXPECT_GT(process.at("user_s").get<double>(), 0.0);
  EXPECT_GT(process.at("peak_memory_bytes").get<std::int64_t>(), 1'000'000);
  EXPECT_GE(process.at("threads").size(), 2U);  // odometry and image decoding
}

TEST(ProfileCommand, ReportsTheWaitsOfThreads) {
  const TemporaryFolder folder;
  ASSERT_EQ(profile(folder, {"--mode", "pipelined"}).exit_code, 0);
  const json profiled = read_json(folder.path() / "profile.json");
  std::vector<std::string> channels;
  for (const json& wait : profiled.at("waits")) {
    channels.push_back(wait.at("channel"));
    EXPECT_GE(wait.at("for_items").at("ns").get<std::int64_t>(), 0);
  }
  EXPECT_EQ(channels, (std::vector<std::string>{"frames to detect", "tracked frames", "detections",
                                                "feedback to the tracker", "decoded frames"}));
}

// The smallest of three: another process may interrupt one.
TEST(ProfileCommand, MeasuresTheOverheadOfItsRecorder) {
  double fraction = 1.0;
  for (int i = 0; i < 3; ++i) {
    const TemporaryFolder folder;
    ASSERT_EQ(profile(folder).exit_code, 0);
    const json recorder = read_json(folder.path() / "profile.json").at("recorder");
    EXPECT_GT(recorder.at("timer_ns").get<double>(), 0.0);
    EXPECT_GT(recorder.at("timers_per_frame").get<double>(), 1.0);
    fraction = std::min(fraction, recorder.at("fraction").get<double>());
  }
  EXPECT_LT(fraction, 0.01);
}

TEST(ProfileCommand, ReportsUnavailableMeasurements) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json profiled = read_json(folder.path() / "profile.json");
  EXPECT_TRUE(profiled.at("allocations_per_frame").is_null());
  EXPECT_NE(result.out.find("stillpoint_counting"), std::string::npos) << result.out;
  const bool counters = !profiled.at("counters").is_null();
  EXPECT_NE(counters, result.out.find("hardware counters: n/a: ") != std::string::npos) << result.out;
  const bool energy = !profiled.at("energy_j").is_null();
  EXPECT_NE(energy, result.out.find("energy: n/a: ") != std::string::npos) << result.out;
}

/// Starts a process that only computes.
pid_t start_busy_process() {
  const pid_t child = fork();
  if (child == 0) {
    for (std::atomic<unsigned> count = 0;; ++count) {
    }
  }
  return child;
}

TEST(ProfileCommand, NamesABusyMachine) {
  // One per ten processors: at least a tenth of the machine is busy, and a load of 5 % is reported.
  std::vector<pid_t> others;
  for (long i = 0; i <= sysconf(_SC_NPROCESSORS_ONLN) / 10; ++i) others.push_back(start_busy_process());
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder);
  for (const pid_t other : others) {
    kill(other, SIGKILL);
    waitpid(other, nullptr, 0);
  }
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("the machine was not idle: other processes used"), std::string::npos)
      << result.out;
  EXPECT_GT(read_json(folder.path() / "profile.json").at("other_load"), 0.05);
}

/// A sensor that shows 4.96 W all the time.
TEST(ProfileCommand, SubtractsTheIdlePower) {
  const TemporaryFolder root;
  const std::string sensor = "sys/bus/i2c/drivers/ina3221/7-0040/hwmon/hwmon3/";
  root.write(sensor + "in1_label", "VDD_IN\n");
  root.write(sensor + "in1_input", "4960\n");    // mV
  root.write(sensor + "curr1_input", "1000\n");  // mA
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--sysfs-root", root.path().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json profiled = read_json(folder.path() / "profile.json");
  EXPECT_GT(profiled.at("energy_j"), 0.0);
  EXPECT_NEAR(profiled.at("idle_power_w"), 4.96, 1e-9);
  const json per_frame = profiled.at("energy_j_per_frame");  // null if rounding makes it less than idle
  EXPECT_TRUE(per_frame.is_null() || per_frame.get<double>() < 1e-9);
  EXPECT_NE(result.out.find("above idle (4.96 W)"), std::string::npos) << result.out;
}

TEST(ProfileCommand, CountsAllocationsInTheCountingProgram) {
  const TemporaryFolder folder;
  const std::string command = std::string(STILLPOINT_BINARY_DIR) + "/stillpoint_counting profile " +
                              rendered_sequence().string() + " --max-frames 20 --out " +
                              folder.path().string() + " >/dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const json counted = read_json(folder.path() / "profile.json").at("allocations_per_frame");
  ASSERT_TRUE(counted.is_object());
  EXPECT_GT(counted.at("median"), 0);  // at least the image itself
  EXPECT_GE(counted.at("largest"), counted.at("median"));
}

TEST(ProfileCommand, SimulatesADeviceWithItsPublishedStageCosts) {
  const TemporaryFolder folder;
  const TemporaryFolder again;
  const std::vector<std::string> device = {"--device", "atlas_200", "--set", "backend.rate_hz=0"};
  const ProgramResult result = profile(folder, device);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = read_json(folder.path() / "device.json");
  // The last of 40 frames arrives after 1.3 s. Until then 1300 / 82.5 = 15 frames are optimized and the 16th
  // is started; at most four more are queued, two of them for the tracker.
  EXPECT_GE(report.at("dropped").get<int>(), kFrames - 20);
  EXPECT_LE(report.at("dropped").get<int>(), kFrames - 16);
  EXPECT_GT(report.at("latency_ms").at("median").get<double>(), 82.0);
  EXPECT_GT(report.at("beyond_budget").get<int>(), 0);
  EXPECT_TRUE(report.at("score").at("ate_rmse_m").is_number());
  ASSERT_EQ(profile(again, device).exit_code, 0);
  EXPECT_EQ(read_json(again.path() / "device.json"), report);  // deterministic, as the costs are fixed
}

TEST(ProfileCommand, RemovesWhatOnlyAnEarlierProfileWrote) {
  const TemporaryFolder folder;
  const auto names = [&] {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      found.insert(entry.path().filename().string());
    return found;
  };
  const std::set<std::string> of_profile{"profile.json", "stacks.folded", "trace.json"};
  const std::set<std::string> of_device{"device.json", "trajectory.tum"};
  ASSERT_EQ(profile(folder).exit_code, 0);
  EXPECT_EQ(names(), of_profile);
  ASSERT_EQ(profile(folder, {"--device", "atlas_200", "--set", "backend.rate_hz=0"}).exit_code, 0);
  EXPECT_EQ(names(), of_device);
  folder.write("result.json", "{}");  // of a run, to which the trajectory may belong
  ASSERT_EQ(profile(folder).exit_code, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"profile.json", "result.json", "stacks.folded", "trace.json",
                                            "trajectory.tum"}));
}

TEST(ProfileCommand, NamesTheDevicesAndTheSystemOfTheirCosts) {
  const TemporaryFolder folder;
  EXPECT_NE(run_program({"profile", "--help"}).out.find("atlas_200, atlas_200_scaled, jetson"),
            std::string::npos);
  const std::string warning = "stage costs are those of \"dynamic_vins\", not of \"stillpoint\"";
  EXPECT_NE(profile(folder, {"--device", "atlas_200"}).err.find(warning), std::string::npos);
  EXPECT_EQ(profile(folder, {"--device", "atlas_200", "--config", "dynamic_vins"}).err, "");
  EXPECT_EQ(profile(folder, {"--device", "x86_2core"}).err, "");
}

TEST(ProfileCommand, RejectsAnUnknownDevice) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--device", "atlas_300"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("did you mean \"atlas_200\"?"), std::string::npos) << result.err;
}

TEST(ProfileCommand, RejectsAnUnknownProcessor) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--cores", "99999"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("not a processor of this machine"), std::string::npos) << result.err;
}

TEST(ProfileCommand, RejectsAZeroBudget) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--frame-budget-ms", "0"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("--frame-budget-ms"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
