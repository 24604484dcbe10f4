// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/coverage.h"

#include <gtest/gtest.h>

namespace stillpoint::eval {
namespace {

/// A curved path with one pose every `step` seconds from `begin` to `end` (inclusive).
Trajectory curved_path(double begin, double end, double step) {
  Trajectory path;
  for (double t = begin; t <= end + 1e-9; t += step) {
    path.poses.push_back({from_seconds(t), Pose{.p = {t, 0.1 * t * t, 0.0}}});
  }
  return path;
}

TEST(Coverage, IsTheFractionOfExpectedFramesWithAPose) {
  const Trajectory est = curved_path(1.0, 2.0, 0.5);  // 1.0, 1.5, 2.0
  std::vector<Timestamp> frames;
  for (const double t : {0.0, 0.5, 1.0, 1.5}) frames.push_back(from_seconds(t));
  EXPECT_DOUBLE_EQ(*coverage(est, frames), 0.5);  // 1.0 and 1.5 of four
}

TEST(Coverage, CountsAPoseForOneFrameOnly) {
  const Trajectory est = curved_path(1.0, 1.0, 1.0);
  const std::vector<Timestamp> frames{from_seconds(0.9995), from_seconds(1.0005)};
  EXPECT_DOUBLE_EQ(*coverage(est, frames), 0.5);
}

TEST(Coverage, IsNotAvailableWithoutExpectedFrames) { EXPECT_FALSE(coverage(curved_path(0, 1, 1), {})); }

TEST(CorrectRate, CountsAPoseAsValidForOneSecondAtMost) {
  // Poses at 0, 0.5, ..., 2 s and none until 10 s; the last pose is valid for 1 s: 3 s of 10 s.
  EXPECT_NEAR(*correct_rate(curved_path(0, 10, 0.1), curved_path(0, 2, 0.5)), 0.3, 1e-9);
}

TEST(CorrectRate, IsZeroForARunWithoutPoses) { EXPECT_EQ(correct_rate(curved_path(0, 10, 0.1), {}), 0.0); }

TEST(CorrectRate, ExcludesPosesBeyondTheThreshold) {
  const Trajectory gt = curved_path(0, 10, 0.1);
  Trajectory est = gt;
  for (StampedPose& pose : est.poses) pose.T_w_f.q = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(correct_rate(gt, est, {.max_rotation_deg = 30.0}), 0.0);  // 1 rad = 57 deg everywhere
  EXPECT_NEAR(*correct_rate(gt, est, {.max_rotation_deg = 60.0}), 1.0, 1e-9);
}

}  // namespace
}  // namespace stillpoint::eval
