// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint profile`: where the time of a run goes.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/rendered_sequence.h"
#include "tests/support/trace_rules.h"

namespace stillpoint {
namespace {

using nlohmann::json;

constexpr int kFrames = 40;

ProgramResult profile(const TemporaryFolder& folder, std::vector<std::string> further = {}) {
  std::vector<std::string> arguments = {"profile",      rendered_sequence().string(),
                                        "--out",        folder.path().string(),
                                        "--max-frames", std::to_string(kFrames)};
  arguments.insert(arguments.end(), further.begin(), further.end());
  return run_program(arguments);
}

json read_json(const std::filesystem::path& file) { return json::parse(std::ifstream(file)); }

json module_of(const json& profile, const std::string& name) {
  for (const json& row : profile.at("modules")) {
    if (row.at("module") == name) return row;
  }
  return nullptr;
}

TEST(ProfileCommand, TimesEveryPicture) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--frame-budget-ms", "1e-6"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("tracking_thread"), std::string::npos) << result.out;
  const json profiled = read_json(folder.path() / "profile.json");
  const json tracking = module_of(profiled, "tracking_thread");
  ASSERT_FALSE(tracking.is_null());
  EXPECT_EQ(tracking.at("calls"), kFrames);
  EXPECT_GT(tracking.at("per_frame_ms").at("median").get<double>(), 0.0);
  // No picture is tracked in a picosecond.
  EXPECT_EQ(profiled.at("deadline").at("missed_by_a_thread_per_stage"), kFrames);
}

TEST(ProfileCommand, WritesAValidTraceOfOneThreadAndOfSeveral) {
  for (const char* mode : {"sequential", "pipelined"}) {
    const TemporaryFolder folder;
    const ProgramResult result = profile(folder, {"--mode", mode});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json trace = read_json(folder.path() / "trace.json");
    EXPECT_EQ(trace_faults(trace), std::vector<std::string>{}) << mode;
    int tracked = 0;
    for (const json& event : trace.at("traceEvents")) tracked += event.at("name") == "tracking_thread";
    EXPECT_EQ(tracked, kFrames) << mode;
  }
}

TEST(ProfileCommand, TellsWhatTheProcessTook) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--cores", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json process = read_json(folder.path() / "profile.json").at("process");
  EXPECT_GT(process.at("user_s").get<double>(), 0.0);
  EXPECT_GT(process.at("peak_memory_bytes").get<std::int64_t>(), 1'000'000);
  EXPECT_GE(process.at("threads").size(), 2U);  // the odometry, and the decoding ahead of it
}

TEST(ProfileCommand, RefusesProcessorsThatAreNotThere) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--cores", "99999"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("no processor of this machine"), std::string::npos) << result.err;
}

TEST(ProfileCommand, RefusesABudgetOfNothing) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--frame-budget-ms", "0"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("--frame-budget-ms"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
