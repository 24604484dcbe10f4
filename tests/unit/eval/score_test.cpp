// SPDX-License-Identifier: BSD-3-Clause
#include "eval/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {
namespace {

TEST(Statistics, HasPercentilesWithLinearInterpolation) {
  // 0 .. 100: the p-th percentile is p; of 0, 1: 0.25, 0.75, ...
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) values.push_back(i);
  const Statistics result = *statistics(values);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    EXPECT_NEAR(result.percentiles[i], kPercentiles[i], 1e-9);
  EXPECT_NEAR(statistics(std::vector<double>{1.0, 0.0})->percentiles[2], 0.95, 1e-12);
  EXPECT_EQ(result.median, 50.0);
}

TEST(Statistics, OfManyValuesAreThoseOfTheSortedList) {
  std::vector<double> values;
  for (int i = 0; i < 40'000; ++i) {
    const double x = static_cast<double>(i * 7919L % 40'000) * 2.5e-5;
    values.push_back(i % 10 == 0 ? 0.25 : x * x * x);  // ties, and most values close to the smallest
  }
  const auto expect_sorted = [&] {
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    const Statistics result = *statistics(values);
    const auto at = [&](double fraction) {  // 39,999 intervals: no fraction falls on a rank
      const double position = fraction * static_cast<double>(sorted.size() - 1);
      const auto rank = static_cast<std::size_t>(position);
      return sorted[rank] + (position - static_cast<double>(rank)) * (sorted[rank + 1] - sorted[rank]);
    };
    EXPECT_DOUBLE_EQ(result.median, at(0.5));
    for (std::size_t i = 0; i < kPercentiles.size(); ++i)
      EXPECT_DOUBLE_EQ(result.percentiles[i], at(0.01 * kPercentiles[i])) << kPercentiles[i];
    EXPECT_EQ(*percentile(values, 0.0), sorted.front());
    EXPECT_EQ(*percentile(values, 1.0), sorted.back());
  };
  expect_sorted();
  values[5000] = 1e12;  // one outlier: all others are in one bucket
  expect_sorted();
  values[5000] = std::numeric_limits<double>::infinity();
  expect_sorted();
}

TEST(PathAngles, SumTheRotationOfTheGroundTruth) {
  std::vector<MatchedPose> matches;
  for (const double angle_deg : {0.0, 10.0, 5.0, 35.0}) {
    const Eigen::AngleAxisd turn(angle_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX());
    matches.push_back({.t = {}, .gt = {Eigen::Quaterniond(turn), {}}, .est = {}});
  }
  const std::vector<double> angles = path_angles_deg(matches);
  EXPECT_NEAR(angles[1], 10.0, 1e-9);
  EXPECT_NEAR(angles[3], 45.0, 1e-9);  // there and back
}

/// 10 s of a curved path with rotation, at 10 Hz.
Trajectory curved_path() {
  Trajectory path;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    const Eigen::Quaterniond q(Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d(1, 2, 3).normalized()));
    path.poses.push_back({Timestamp{i * 100'000'000LL}, Pose{q, {t, std::sin(t), 0.2 * std::cos(2 * t)}}});
  }
  return path;
}

TEST(AlignSe3, RecoversAKnownRigidTransform) {
  const Trajectory gt = curved_path();
  const Pose T_v_w{Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(3, -1, 2).normalized())),
                   {5, -6, 7}};
  Trajectory est = gt;
  for (StampedPose& pose : est.poses) pose.T_w_f = T_v_w * pose.T_w_f;
  const std::optional<AteResult> result = ate(gt, est);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pairs, 101u);
  EXPECT_LT(result->translation_m.max, 1e-12);
  EXPECT_LT(result->rotation_deg.max, 1e-6);
  EXPECT_TRUE(result->alignment.determined);
}

TEST(AlignSe3, IsNotDeterminedByALine) {
  Trajectory line;
  for (int i = 0; i < 10; ++i)
    line.poses.push_back({Timestamp{i * 100'000'000LL}, Pose{.p = {1.0 * i, 0, 0}}});
  const std::optional<AteResult> result = ate(line, line);
  ASSERT_TRUE(result);
  EXPECT_LT(result->translation_m.max, 1e-12);
  EXPECT_FALSE(result->alignment.determined);
}

TEST(AteStatistics, MatchAHandComputedCase) {
  // Ground truth at the corners of a square around 0, estimate at those of the square scaled by 1.5: the
  // alignment is the identity and the error of every corner is 0.5 * sqrt(2) m.
  Trajectory gt;
  Trajectory est;
  const double corners[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  for (int i = 0; i < 4; ++i) {
    gt.poses.push_back({Timestamp{i * 1'000'000'000LL}, Pose{.p = {corners[i][0], corners[i][1], 0}}});
    est.poses.push_back(
        {Timestamp{i * 1'000'000'000LL}, Pose{.p = {1.5 * corners[i][0], 1.5 * corners[i][1], 0}}});
  }
  const std::optional<AteResult> result = ate(gt, est);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->translation_m.rmse, 0.5 * std::numbers::sqrt2, 1e-12);
  EXPECT_NEAR(result->translation_m.std, 0.0, 1e-12);
}

TEST(Rpe, MeasuresAConstantDriftPerSecond) {
  // On a straight path the estimate has an error of 0.02 m/s along x and 0.01 rad/s about x, so these are the
  // errors of every pair 1 s apart.
  Trajectory gt;
  Trajectory est;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.01 * t, Eigen::Vector3d::UnitX()));
    gt.poses.push_back({Timestamp{i * 100'000'000LL}, Pose{.p = {t, 0, 0}}});
    est.poses.push_back({Timestamp{i * 100'000'000LL}, Pose{turn, {1.02 * t, 0, 0}}});
  }
  const std::optional<RpeResult> result = rpe(gt, est);
  ASSERT_TRUE(result);
  // Starts at 0 .. 8.9 s; the pair that starts at 9.0 s ends at the last pose and is dropped.
  EXPECT_EQ(result->translation_m.count, 90u);
  EXPECT_NEAR(result->translation_m.rmse, 0.02, 1e-9);
  EXPECT_NEAR(result->rotation_deg.rmse, 0.01 * 180.0 / std::numbers::pi, 1e-9);
}

TEST(Score, IsNotAvailableWithoutPosesExceptForAZeroCorrectRate) {
  const Score lost = score(curved_path(), {}, {.expected_times = {Timestamp{0}, Timestamp{1}}});
  EXPECT_FALSE(lost.ate);
  EXPECT_FALSE(lost.rpe);
  EXPECT_FALSE(lost.first_pose_s);
  EXPECT_EQ(lost.correct_rate, 0.0);
  EXPECT_EQ(lost.coverage, 0.0);
}

TEST(Score, HasOnlyCoverageWithoutGroundTruth) {
  const Score without_gt = score({}, curved_path(), {.expected_times = {Timestamp{0}}});
  EXPECT_FALSE(without_gt.ate);
  EXPECT_FALSE(without_gt.correct_rate);
  EXPECT_EQ(without_gt.coverage, 1.0);
  EXPECT_EQ(without_gt.first_pose_s, 0.0);
}

TEST(Score, IsPerfectForTheGroundTruthItself) {
  const Score perfect = score(curved_path(), curved_path());
  EXPECT_NEAR(perfect.ate->translation_m.rmse, 0.0, 1e-12);
  EXPECT_NEAR(perfect.rpe->translation_m.rmse, 0.0, 1e-12);
  EXPECT_NEAR(*perfect.correct_rate, 1.0, 1e-12);
  EXPECT_FALSE(perfect.coverage);
}

TEST(MoveToFrame, MultipliesByTheExtrinsicsFromTheRight) {
  const Pose T_f_g{Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
                   {1, 0, 0}};
  Trajectory body{.frame = "imu", .poses = {{Timestamp{0}, Pose{T_f_g.q, {0, 0, 0}}}}};
  const Trajectory camera = move_to_frame(body, T_f_g, "camera");
  // The body is rotated by 90 degrees about z, so 1 m along its x axis is 1 m along y in the world.
  EXPECT_TRUE(camera.poses[0].T_w_f.p.isApprox(Eigen::Vector3d(0, 1, 0)));
  EXPECT_EQ(camera.frame, "camera");
}

}  // namespace
}  // namespace stillpoint::eval
