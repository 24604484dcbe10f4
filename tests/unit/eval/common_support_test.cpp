// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/common_support.h"

#include <gtest/gtest.h>

#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::eval {
namespace {

/// The smooth path with an error along x that grows by `slope` [m/s].
Trajectory drifting(std::size_t count, double slope) {
  Trajectory path = test::smooth_path(count, 0.1);
  for (StampedPose& pose : path.poses) pose.T_w_f.p.x() += slope * to_seconds(pose.t);
  return path;
}

TEST(CompareRuns, RanksALostRunLastEvenIfItsErrorIsTheSmallest) {
  const Trajectory gt = test::smooth_path(6001, 0.01);  // 60 s
  const std::vector<NamedRun> runs{{"lost after 5 s", drifting(51, 0.0)},
                                   {"coarse", drifting(601, 0.02)},
                                   {"fine", drifting(601, 0.01)},
                                   {"no poses", {}}};
  const Comparison comparison = compare_runs(gt, runs);
  ASSERT_EQ(comparison.ranking.size(), 4u);
  EXPECT_EQ(comparison.ranking[0].name, "fine");
  EXPECT_EQ(comparison.ranking[1].name, "coarse");
  EXPECT_EQ(comparison.ranking[2].name, "lost after 5 s");
  EXPECT_NEAR(*comparison.ranking[2].own_ate_rmse_m, 0.0, 1e-4);  // the smallest error of all runs
  EXPECT_TRUE(comparison.ranking[2].failed);
  EXPECT_NEAR(comparison.ranking[2].coverage, 6.0 / 60.0, 1e-9);  // 5 s, and 1 s validity of the last pose
  EXPECT_FALSE(comparison.ranking[3].own_ate_rmse_m);
  EXPECT_NEAR(comparison.common_s, 60.0, 1e-9);  // failed runs do not restrict the common support
}

TEST(CompareRuns, ARunWithOnePoseHasFailed) {
  const Trajectory gt = test::smooth_path(1000, 0.1);
  Trajectory one = gt;
  one.poses.resize(1);
  Trajectory start = gt;  // of 1 s
  start.poses.resize(10);
  const std::vector<NamedRun> runs = {{"one", one}, {"all", gt}};
  CompareOptions options;
  options.min_coverage = 0.0;
  const Comparison comparison = compare_runs(gt, runs, options);
  EXPECT_EQ(comparison.ranking[0].name, "all");
  EXPECT_GT(comparison.ranking[0].common_rpe_pairs, 900U);
  EXPECT_TRUE(comparison.ranking[1].failed);
  EXPECT_FALSE(comparison.ranking[1].common_rpe_m || comparison.ranking[1].own_ate_rmse_m);
}

TEST(CompareRuns, HasNoRelativeErrorsWithoutOrientations) {
  const Trajectory gt = test::smooth_path(1000, 0.1);
  Trajectory identity = gt;
  for (StampedPose& pose : identity.poses) pose.T_w_f.q.setIdentity();
  const Comparison comparison = compare_runs(gt, std::vector<NamedRun>{{"a", identity}});
  EXPECT_LT(*comparison.ranking[0].common_ate_rmse_m, 1e-9);
  EXPECT_FALSE(comparison.ranking[0].common_rpe_m || comparison.ranking[0].common_rpe_deg);
}

TEST(CompareRuns, RanksByTheErrorOverTheCommonSupport) {
  const Trajectory gt = test::smooth_path(6001, 0.01);
  // "short" ends at 40 s and drifts; "whole" is exact until 41 s and 5 m off afterwards.
  Trajectory whole = test::smooth_path(601, 0.1);
  for (StampedPose& pose : whole.poses) {
    if (to_seconds(pose.t) > 41.0) pose.T_w_f.p.z() += 5.0;
  }
  const std::vector<NamedRun> runs{{"short", drifting(401, 0.001)}, {"whole", whole}};
  const Comparison comparison = compare_runs(gt, runs);
  EXPECT_NEAR(comparison.common_s, 41.0, 1e-9);
  // Better where both have poses, although the ATE over all its poses is worse.
  EXPECT_EQ(comparison.ranking[0].name, "whole");
  EXPECT_GT(*comparison.ranking[0].own_ate_rmse_m, 1.0);
  EXPECT_LT(*comparison.ranking[0].common_ate_rmse_m, 1e-4);
}

}  // namespace
}  // namespace stillpoint::eval
