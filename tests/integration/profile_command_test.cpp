// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint profile`: where the time of a run goes.
#include <cstdlib>
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

TEST(ProfileCommand, TellsWhereThreadsWaited) {
  const TemporaryFolder folder;
  ASSERT_EQ(profile(folder, {"--mode", "pipelined"}).exit_code, 0);
  const json profiled = read_json(folder.path() / "profile.json");
  std::vector<std::string> channels;
  for (const json& wait : profiled.at("waits")) {
    channels.push_back(wait.at("channel"));
    EXPECT_GE(wait.at("for_items").at("ns").get<std::int64_t>(), 0);
  }
  EXPECT_EQ(channels, (std::vector<std::string>{"pictures to detect in", "tracked pictures", "detections",
                                                "feedback to the tracker", "decoded pictures"}));
}

TEST(ProfileCommand, MeasuresItsOwnRecorder) {
  const TemporaryFolder folder;
  ASSERT_EQ(profile(folder).exit_code, 0);
  const json recorder = read_json(folder.path() / "profile.json").at("recorder");
  EXPECT_GT(recorder.at("timer_ns").get<double>(), 0.0);
  EXPECT_GT(recorder.at("timers_per_frame").get<double>(), 1.0);
  EXPECT_LT(recorder.at("share").get<double>(), 0.01);
}

TEST(ProfileCommand, SaysWhatItCannotMeasure) {
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

TEST(ProfileCommand, CountsAllocationsInTheProgramThatCanDoSo) {
  const TemporaryFolder folder;
  const std::string command = std::string(STILLPOINT_BINARY_DIR) + "/stillpoint_counting profile " +
                              rendered_sequence().string() + " --max-frames 20 --out " +
                              folder.path().string() + " >/dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const json counted = read_json(folder.path() / "profile.json").at("allocations_per_frame");
  ASSERT_TRUE(counted.is_object());
  EXPECT_GT(counted.at("median"), 0);  // at least the picture itself
  EXPECT_GE(counted.at("largest"), counted.at("median"));
}

TEST(ProfileCommand, JudgesABoardByItsPublishedCosts) {
  const TemporaryFolder folder;
  const TemporaryFolder again;
  const std::vector<std::string> board = {"--board", "atlas_200", "--set", "backend.rate_hz=0"};
  const ProgramResult result = profile(folder, board);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json judged = read_json(folder.path() / "board.json");
  // The last of 40 pictures comes after 1.3 s: until then 1300 / 82.5 = 15 are optimised and the 16th begun;
  // four more wait at most, two of them for the tracker.
  EXPECT_GE(judged.at("dropped").get<int>(), kFrames - 20);
  EXPECT_LE(judged.at("dropped").get<int>(), kFrames - 16);
  EXPECT_GT(judged.at("latency_ms").at("median").get<double>(), 82.0);
  EXPECT_GT(judged.at("beyond_budget").get<int>(), 0);
  EXPECT_TRUE(judged.at("score").at("ate_rmse_m").is_number());
  ASSERT_EQ(profile(again, board).exit_code, 0);
  EXPECT_EQ(read_json(again.path() / "board.json"), judged);  // costs are fixed, so every run is the same
}

TEST(ProfileCommand, RefusesABoardThatIsNotThere) {
  const TemporaryFolder folder;
  const ProgramResult result = profile(folder, {"--board", "atlas_300"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("did you mean \"atlas_200\"?"), std::string::npos) << result.err;
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
