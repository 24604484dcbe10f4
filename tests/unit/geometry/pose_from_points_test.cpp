// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/pose_from_points.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

const Pose kTcw{exp_so3({0.1, -0.2, 0.05}), {0.3, -0.1, 0.2}};

/// Points 2 to 5 m in front of the camera, observed without error.
std::vector<PointObservation> observe(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> lateral(-0.5, 0.5);
  std::uniform_real_distribution<double> depth(2.0, 5.0);
  std::vector<PointObservation> observations;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d bearing(lateral(random), lateral(random));
    observations.push_back(
        {kTcw.inverse() * Eigen::Vector3d(depth(random) * bearing.homogeneous()), bearing});
  }
  return observations;
}

double distance(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() + log_so3(a.q.conjugate() * b.q).norm();
}

TEST(PoseFromPoints, JacobianIsThatOfCentralDifferences) {
  const Eigen::Vector3d p(0.4, -0.7, 1.6);
  const auto projection = [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x.x() / x.z(), x.y() / x.z(), 1.0 / x.z());
  };
  Eigen::Matrix3d expected;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = 1e-6 * Eigen::Vector3d::Unit(i);
    expected.col(i) = (projection(p + d) - projection(p - d)) / 2e-6;
  }
  // Error of central differences: about (1e-6)^2, and 1e-16 / 1e-6 of rounding.
  EXPECT_TRUE(inverse_depth_jacobian(p.hnormalized(), 1.0 / p.z()).isApprox(expected, 1e-8));
  EXPECT_TRUE(bearing_jacobian(p.hnormalized(), 1.0 / p.z()).isApprox(expected.topRows<2>(), 1e-8));
}

TEST(PoseFromPoints, RefinementConvergesFromFifteenDegrees) {
  const Pose initial = Pose{exp_so3({0.0, 0.26, 0.0}), Eigen::Vector3d::Zero()} * kTcw;
  EXPECT_LT(distance(refine_pose(initial, observe(40), {.scale = 1.0, .steps = 8}), kTcw), 1e-9);
}

TEST(PoseFromPoints, RefinementConvergesFromAnyRotationAfterATurnToTheBearings) {
  const Pose initial = Pose{exp_so3({1.5, 2.0, -0.5}), Eigen::Vector3d(0.2, 0.1, -0.3)} * kTcw;
  const Pose turned = turn_to_bearings(initial, observe(40));
  EXPECT_LT((turned.inverse().p - initial.inverse().p).norm(), 1e-12);
  EXPECT_LT(distance(refine_pose(turned, observe(40), {.scale = 1.0, .steps = 8}), kTcw), 1e-9);
}

TEST(PoseFromPoints, RefinementWithoutPointsReturnsTheInitialPose) {
  EXPECT_LT(distance(refine_pose(kTcw, {}, {}), kTcw), 1e-15);
}

TEST(PoseFromPoints, CountsObservationsBelowTheThresholdInFrontOfTheCamera) {
  std::vector<PointObservation> observations = observe(10);
  observations[0].bearing.x() += 0.009;
  observations[1].bearing.x() += 0.011;
  observations[2].p_w = kTcw.inverse() * -(kTcw * observations[2].p_w);  // behind, with the same bearing
  EXPECT_EQ(count_inliers(kTcw, observations, 0.01), 8u);
}

TEST(PoseFromPoints, RequiredSamplesFollowFischlerAndBolles) {
  // log(0.01) / log(1 - 0.5^4) = -4.605 / -0.06454
  EXPECT_NEAR(required_samples(0.5, {.sample_size = 4, .confidence = 0.99}), 71.36, 0.01);
  EXPECT_EQ(required_samples(1.0, {.sample_size = 4, .confidence = 0.99}), 0.0);
}

TEST(PoseFromPoints, ConsensusFindsThePoseAmongHalfOutliers) {
  std::vector<PointObservation> observations = observe(80);
  for (std::size_t i = 0; i < observations.size(); i += 2) observations[i].bearing.x() += 0.1;
  std::mt19937 random(1);
  // A sample is free of outliers with probability 1/16: 200 contain one, but for 3e-6.
  const PoseConsensus found =
      sample_poses(observations, Pose{}, {.consensus = {.max_samples = 200}}, std::ref(random));
  EXPECT_EQ(found.inliers, 40u);
  EXPECT_LT(distance(found.pose, kTcw), 1e-3);
}

TEST(PoseFromPoints, ConsensusStopsWhenEnoughSamplesAreDrawn) {
  const std::vector<PointObservation> observations = observe(20);
  std::mt19937 random(1);
  std::size_t calls = 0;
  const auto count_calls = [&] {
    ++calls;
    return static_cast<std::size_t>(random());
  };
  const PoseSampling sampling{.consensus = {.confidence = 0.99}, .refinement = {.steps = 8}};
  const PoseConsensus found = sample_poses(observations, kTcw, sampling, count_calls);
  EXPECT_EQ(found.inliers, 20u);
  EXPECT_EQ(calls, 4u);  // all agree with the first sample
}

/// A camera whose view is covered but for a tenth at either side, with 36 points behind, 2 m away and
/// observed with an error of 0.2 px at 600 px, and unless its error is 0, one point of the person 0.45 m
/// before it, with the error of a track that the inertial prediction led to another place of the clothes.
std::vector<PointObservation> observe_beside_a_person(std::uint32_t seed, double mover_px) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> column(0.56, 0.7), row(-0.4, 0.4), angle(0.0, 6.283);
  std::normal_distribution<double> error(0.0, 0.2 / 600.0);
  const auto observe_at = [&](double x, double depth, const Eigen::Vector2d& difference) {
    const Eigen::Vector2d bearing(x, row(random));
    return PointObservation{kTcw.inverse() * Eigen::Vector3d(depth * bearing.homogeneous()),
                            bearing + difference};
  };
  std::vector<PointObservation> observations;
  for (int i = 0; i < 36; ++i) {
    const double x = (i % 2 == 0 ? 1.0 : -1.0) * column(random);
    const double error_x = error(random);
    observations.push_back(observe_at(x, 2.0, {error_x, error(random)}));
  }
  if (mover_px == 0.0) return observations;
  const double direction = angle(random);
  observations.push_back(
      observe_at(0.2, 0.45, mover_px / 600.0 * Eigen::Vector2d(std::cos(direction), std::sin(direction))));
  return observations;
}

/// Sum of the squared errors of the position over 20 seeds.
double squared_position_errors(double mover_px) {
  double sum = 0.0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose found =
        refine_camera_pose(observe_beside_a_person(seed, mover_px), kTcw.inverse(), 3.0 / 600.0);
    sum += (found.p - kTcw.inverse().p).squaredNorm();
  }
  return sum;
}

TEST(PoseFromPoints, OneNearPointOfAMoverDoesNotOutweighManyDistantOnes) {
  // One error in 37 costs little. With a loss as wide as the inlier threshold, the pose follows the near
  // point by 8 mm, against an error of 1.3 mm without it: a ratio of 38.
  EXPECT_LT(squared_position_errors(9.0), 2.0 * squared_position_errors(0.0));
}

TEST(PoseFromPoints, RefinementFromAWrongPredictionConverges) {
  // 20 px, as after a tenth of a second with a gyroscope that errs by 20 deg/s.
  const Pose wrong = (Pose{exp_so3({0.0, 20.0 / 600.0, 0.0}), Eigen::Vector3d::Zero()} * kTcw).inverse();
  EXPECT_LT(distance(refine_camera_pose(observe(60), wrong, 3.0 / 600.0).inverse(), kTcw), 1e-4);
}

}  // namespace
}  // namespace stillpoint
