// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/plan_runner.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace stillpoint::bench {
namespace {

RunOutcome outcome_with(const std::string& result) {
  RunOutcome outcome;
  outcome.attachments["result"] = result;
  outcome.costs.push_back({.module = "image_decoding", .per = "call", .calls = 100, .mean_ms = 20.0});
  return outcome;
}

TEST(HarnessProfile, DividesTheTimeOfAProcess) {
  const HarnessProfile profile = with_run(
      {}, {.wall_s = 10.0}, outcome_with(R"({"wall_s": 8.0, "image_waits_s": 3.0, "start_s": 0.5})"));
  EXPECT_EQ(profile.runs, 1u);
  EXPECT_DOUBLE_EQ(profile.odometry_s, 5.0);
  EXPECT_DOUBLE_EQ(profile.image_waits_s, 3.0);
  EXPECT_DOUBLE_EQ(profile.start_s, 0.5);
  EXPECT_DOUBLE_EQ(profile.output_s, 1.5);
  EXPECT_DOUBLE_EQ(profile.decoding_s, 2.0);
  EXPECT_DOUBLE_EQ(profile.other_process_s, 0.0);
}

TEST(HarnessProfile, CountsProcessesWithoutTimesAsWholes) {
  HarnessProfile profile = with_run({}, {.wall_s = 4.0}, {});
  profile = with_run(profile, {.wall_s = 2.0}, outcome_with("not json"));
  EXPECT_EQ(profile.runs, 2u);
  EXPECT_DOUBLE_EQ(profile.other_process_s, 6.0);
  EXPECT_DOUBLE_EQ(profile.odometry_s, 0.0);
}

TEST(HarnessProfile, TheRestOfTheTimeOfAllWorkersIsIdle) {
  HarnessProfile profile = with_run({}, {.wall_s = 4.0}, {});
  profile.workers = 2;
  profile.wall_s = 5.0;
  EXPECT_DOUBLE_EQ(profile.idle_s(), 6.0);  // 2 * 5 - 4
  EXPECT_NE(profile_text(profile).find("no run to execute              6.00 s   60.0 %"), std::string::npos)
      << profile_text(profile);
  EXPECT_EQ(nlohmann::json::parse(profile_json(profile)).at("idle_s"), 6.0);
}

}  // namespace
}  // namespace stillpoint::bench
