// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/path_spline.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "datasets/synthetic/motion/camera_motion.h"

namespace stillpoint::synth {
namespace {

constexpr double kStep_s = 1e-4;

PathSpline rolling_path() {
  return hand_path(HandMotion::kRpy, {{0.0, -2.0, 1.5}, {0.0, 0.0, 1.0}}, {Pose{}, 7, 0.0, 5.0});
}

TEST(PathSpline, WeightsReproduceConstants) {
  // The weights sum to 1, those of derivatives to 0.
  for (const double u : {0.0, 0.3, 0.99}) {
    for (int order = 0; order <= 2; ++order) {
      double sum = 0.0;
      for (const double weight : quintic_weights(u, order)) sum += weight;
      EXPECT_NEAR(sum, order == 0 ? 1.0 : 0.0, 1e-12);
    }
  }
}

TEST(PathSpline, VelocityAndAccelerationAreDerivativesOfPosition) {
  const PathSpline path = rolling_path();
  for (const double t : {0.5, 1.234, 4.9}) {
    const Eigen::Vector3d before = path.pose_at(t - kStep_s).p, here = path.pose_at(t).p,
                          behind = path.pose_at(t + kStep_s).p;
    EXPECT_LT(((behind - before) / (2.0 * kStep_s) - path.at(t).velocity_w).norm(), 1e-5);
    // Second difference: rounding 1e-16 / kStep^2 = 1e-8, truncation kStep^2 / 12 * p'''' < 1e-5.
    EXPECT_LT(((behind - 2.0 * here + before) / (kStep_s * kStep_s) - path.at(t).acceleration_w).norm(),
              1e-4);
  }
}

TEST(PathSpline, AngularRateIsTheDerivativeOfAttitude) {
  const PathSpline path = rolling_path();
  for (const double t : {0.5, 1.234, 4.9}) {
    const Eigen::Quaterniond change = path.pose_at(t - kStep_s).q.conjugate() * path.pose_at(t + kStep_s).q;
    EXPECT_LT((log_so3(change) / (2.0 * kStep_s) - path.at(t).rate_b).norm(), 1e-5);
  }
}

TEST(PathSpline, IsConstantBeyondItsEnds) {
  const PathSpline path = rolling_path();
  EXPECT_LT((path.pose_at(path.last_s()).p - path.pose_at(path.last_s() + 1.0).p).norm(), 1e-9);
}

TEST(SpecificForce, IsPlusOneGravityUpwardsAtRest) {
  BodyMotion still{};
  EXPECT_LT((specific_force(still) - Eigen::Vector3d(0.0, 0.0, 9.81)).norm(), 1e-12);
}

}  // namespace
}  // namespace stillpoint::synth
