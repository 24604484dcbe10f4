// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/ate.h"

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

std::vector<Timestamp> frames_at(double rate_hz, int count) {
  std::vector<Timestamp> frames;
  for (int i = 0; i < count; ++i) frames.push_back(from_seconds(i / rate_hz));
  return frames;
}

TEST(Coverage, IsCompleteForASystemThatReportsMoreOftenThanThereAreFrames) {
  // 30 Hz frames and poses at 100 Hz: only every third frame has a pose at exactly its time.
  EXPECT_DOUBLE_EQ(*coverage(curved_path(0.0, 10.0, 0.01), frames_at(30.0, 300)), 1.0);
  EXPECT_DOUBLE_EQ(*coverage(curved_path(5.0, 10.0, 0.01), frames_at(30.0, 300)), 0.5);  // lost for 5 s
}

TEST(Coverage, IsOneHalfForASystemThatReportsEverySecondFrame) {
  EXPECT_DOUBLE_EQ(*coverage(curved_path(0.0, 10.0, 1.0 / 15.0), frames_at(30.0, 300)), 0.5);
}

TEST(Coverage, AFrameBesideALostOneDoesNotCoverBoth) {
  Trajectory est = curved_path(0.0, 1.0, 0.1);
  est.poses.erase(est.poses.begin() + 5);
  EXPECT_DOUBLE_EQ(*coverage(est, frames_at(10.0, 11)), 10.0 / 11.0);
}

TEST(FirstPose, IsZeroIfASystemReportsAPoseBeforeTheFirstFrame) {
  EXPECT_EQ(first_pose_seconds(curved_path(0.99, 2.0, 0.01), from_seconds(1.0)), 0.0);
  EXPECT_NEAR(*first_pose_seconds(curved_path(1.25, 2.0, 0.01), from_seconds(1.0)), 0.25, 1e-9);
}

TEST(Coverage, IsNotAvailableWithoutExpectedFrames) { EXPECT_FALSE(coverage(curved_path(0, 1, 1), {})); }

TEST(CorrectRate, CountsAPoseAsValidForOneSecondAtMost) {
  // Poses at 0, 0.5, ..., 2 s and none until 10 s; the last pose is valid for 1 s: 3 s of 10 s.
  EXPECT_NEAR(*correct_rate(curved_path(0, 10, 0.1), curved_path(0, 2, 0.5)), 0.3, 1e-9);
}

TEST(CorrectRate, IsZeroForARunWithoutPoses) { EXPECT_EQ(correct_rate(curved_path(0, 10, 0.1), {}), 0.0); }

TEST(CorrectRate, IsNotAvailableIfTheGroundTruthIsTooSparseToTell) {
  // One true pose per 1.2 s: no estimated pose has both neighbors within 0.5 s.
  const Trajectory gt = curved_path(0, 12, 1.2);
  EXPECT_FALSE(correct_rate(gt, curved_path(0.05, 11, 0.1)));
  EXPECT_EQ(correct_rate(gt, curved_path(20, 30, 0.1)), 0.0);  // after its end, as if there were no pose
}

TEST(CorrectRate, IsExactlyOneForACorrectPoseAtAllTimes) {
  for (const double rate_hz : {10.0, 15.0, 30.0, 60.0, 200.0}) {
    const Trajectory gt = curved_path(0, 60, 1.0 / rate_hz);
    EXPECT_EQ(correct_rate(gt, gt), 1.0) << rate_hz << " Hz";  // a sum of rounded intervals was above 1
  }
}

TEST(TimeCoverage, IsExactlyZeroIfTheWholeTimeIsLost) {
  const TimeSpan whole{{}, from_seconds(100.0)};
  for (int i = 1; i < 1000;
       ++i) {  // lost in two parts, whose rounded lengths may add up to more than the whole
    const Timestamp between = from_seconds(0.1 * i + 1e-9 * i * i);
    EXPECT_EQ(time_coverage(std::vector<TimeSpan>{{whole.begin, between}, {between, whole.end}}, whole), 0.0)
        << i;
  }
}

TEST(CorrectRate, ExcludesPosesBeyondTheThreshold) {
  const Trajectory gt = curved_path(0, 10, 0.1);
  Trajectory est = gt;
  for (StampedPose& pose : est.poses) pose.T_w_f.q = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(correct_rate(gt, est, {.max_rotation_deg = 30.0}), 0.0);  // 1 rad = 57 deg everywhere
  EXPECT_NEAR(*correct_rate(gt, est, {.max_rotation_deg = 60.0}), 1.0, 1e-9);
}

}  // namespace
}  // namespace stillpoint::eval
