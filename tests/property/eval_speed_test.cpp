// SPDX-License-Identifier: BSD-3-Clause
/// A million poses: time must grow with n log n at most.
#include <gtest/gtest.h>

#include <cstdio>
#include <ctime>
#include <memory>

#include "eval/io/trajectory_file.h"
#include "eval/recipes/recipe.h"
#include "eval/score.h"
#include "tests/support/smooth_path.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMillion = 1'000'000;

/// Processor time, so that a busy machine does not count.
template <class Action>
double seconds_of(const Action& action) {
  const std::clock_t begin = std::clock();
  action();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
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

TEST_F(MillionPoses, AteAndRpeTakeThreeSecondsAtMost) {
  Score result;
  const double seconds = seconds_of([&] { result = score(*gt_, *est_); });
  RecordProperty("seconds", std::to_string(seconds));
  std::printf("ATE, RPE and correct rate of 1,000,000 poses: %.2f s\n", seconds);
  EXPECT_EQ(result.ate_pairs, kMillion);
  EXPECT_GT(result.rpe_pairs, kMillion - 300);
  EXPECT_LE(seconds, 3.0);
}

TEST_F(MillionPoses, EveryRecipeEndsInTenSeconds) {
  for (const Recipe& recipe : recipes()) {
    const double seconds = seconds_of([&] {
      static_cast<void>(evaluate(recipe.name, {*gt_, *est_, RecipeOptions{}}));
    });
    std::printf("%s: %.2f s\n", std::string(recipe.name).c_str(), seconds);
    EXPECT_LE(seconds, 10.0) << recipe.name;
  }
}

TEST_F(MillionPoses, TextIsReadInFiveSeconds) {
  const std::string text = format_tum(*gt_);
  const double seconds =
      seconds_of([&] { EXPECT_EQ(parse_tum(text, "a").trajectory.poses.size(), kMillion); });
  std::printf("reading 1,000,000 poses (%.0f MB): %.2f s\n", static_cast<double>(text.size()) * 1e-6,
              seconds);
  EXPECT_LE(seconds, 5.0);
}

}  // namespace
}  // namespace stillpoint
