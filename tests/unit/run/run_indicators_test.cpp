// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_indicators.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

RunResult located_run() {
  RunResult result;
  for (int i = 0; i < 90; ++i) {
    result.run.claims.push_back({.t = from_seconds(i / 30.0), .claim = eval::PoseClaim::kLocated});
    result.run.innovations.push_back({.reprojection = 1.0, .inertial = 0.3});
  }
  return result;
}

TEST(RunIndicators, AreSilentAboutASoundRun) { EXPECT_TRUE(run_indicators(located_run()).empty()); }

TEST(RunIndicators, NameTheInnovationsThatAreTooLarge) {
  RunResult result = located_run();
  for (Innovations& frame : result.run.innovations) frame.inertial = 10.0;
  ASSERT_EQ(run_indicators(result).size(), 1U);
  EXPECT_EQ(run_indicators(result)[0], "NIS inertial 10.0: the IMU is noisier than stated");
}

TEST(RunIndicators, CountLostFramesAfterTheFirstSecond) {
  RunResult result = located_run();
  for (std::size_t i = 0; i < 25; ++i) result.run.claims[i].claim = eval::PoseClaim::kNone;
  EXPECT_TRUE(run_indicators(result).empty());
  for (std::size_t i = 40; i < 55; ++i) result.run.claims[i].claim = eval::PoseClaim::kLost;
  ASSERT_EQ(run_indicators(result).size(), 1U);
  EXPECT_EQ(run_indicators(result)[0], "25 % of the frames after the first second have no pose");
}

}  // namespace
}  // namespace stillpoint::bench
