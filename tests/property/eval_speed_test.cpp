// SPDX-License-Identifier: BSD-3-Clause
/// Run time on a million poses: O(n log n) at most.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>

#include "eval/compare/conventions.h"
#include "eval/io/trajectory_file.h"
#include "eval/protocols/protocol.h"
#include "eval/score.h"
#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kMillion = 1'000'000;

/// CPU time. Other processes lengthen it by a part, as they share caches and memory.
template <class Action>
double seconds_of(const Action& action) {
  const std::clock_t begin = std::clock();
  action();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// The least of three measurements.
template <class Action>
double least_seconds_of(const Action& action) {
  double least = seconds_of(action);
  for (int i = 1; i < 3; ++i) least = std::min(least, seconds_of(action));
  return least;
}

class MillionPoses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    gt_ = std::make_unique<Trajectory>(test::smooth_path(kMillion, 0.005));
    est_ = std::make_unique<Trajectory>(test::smooth_path(kMillion, 0.005, 0.001));
  }
  static void TearDownTestSuite() {
    gt_.reset();
    est_.reset();
  }
  static inline std::unique_ptr<Trajectory> gt_;
  static inline std::unique_ptr<Trajectory> est_;
};

TEST_F(MillionPoses, ScoreTakesAtMostThreeSeconds) {
  Score result;
  const double seconds = least_seconds_of([&] { result = score(*gt_, *est_); });
  RecordProperty("seconds", std::to_string(seconds));
  std::printf("ATE, RPE and correct rate of 1,000,000 poses: %.2f s\n", seconds);
  EXPECT_EQ(result.ate.value().pairs, kMillion);
  EXPECT_GT(result.rpe.value().translation_m.count, kMillion - 300);
  EXPECT_LE(seconds, 3.0);
}

TEST_F(MillionPoses, EveryProtocolTakesAtMostTenSeconds) {
  for (const Protocol& protocol : protocols()) {
    const double seconds = seconds_of([&] {
      static_cast<void>(evaluate(protocol.name, {*gt_, *est_, ProtocolOptions{}}));
    });
    std::printf("%s: %.2f s\n", std::string(protocol.name).c_str(), seconds);
    EXPECT_LE(seconds, 10.0) << protocol.name;
  }
}

TEST_F(MillionPoses, ChecksOfConventionsTakeAtMostTwoSeconds) {
  const double seconds =
      least_seconds_of([&] { EXPECT_TRUE(find_convention_violations(*gt_, *est_).empty()); });
  std::printf("conventions of 1,000,000 poses: %.2f s\n", seconds);
  EXPECT_LE(seconds, 2.0);
}

TEST_F(MillionPoses, ParsingTakesAtMostFiveSeconds) {
  const std::string text = format_tum(*gt_);
  const double seconds =
      seconds_of([&] { EXPECT_EQ(parse_tum(text, "a").trajectory.poses.size(), kMillion); });
  std::printf("parsing 1,000,000 poses (%.0f MB): %.2f s\n", static_cast<double>(text.size()) * 1e-6,
              seconds);
  EXPECT_LE(seconds, 5.0);
}

}  // namespace
}  // namespace stillpoint::eval
