// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/outliers/outlier_rejection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

std::vector<PointObservation> observe(const Pose& T_to_from, int count) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> lateral(-0.6, 0.6);
  std::uniform_real_distribution<double> depth_distribution(1.0, 5.0);
  std::vector<PointObservation> correspondences;
  for (int i = 0; i < count; ++i) {
    const double depth = depth_distribution(random);
    const Eigen::Vector3d point(depth * lateral(random), depth * lateral(random), depth);
    correspondences.push_back({point, (T_to_from * point).hnormalized()});
  }
  return correspondences;
}

TEST(RigidMotion, EstimatesTheMotionWithAThirdOfOutliers) {
  const Pose truth{exp_so3({0.02, -0.03, 0.05}), {0.05, -0.02, 0.08}};
  std::vector<PointObservation> correspondences = observe(truth, 90);
  for (std::size_t i = 0; i < 30; ++i) correspondences[3 * i].bearing.x() += 0.05;
  const std::optional<Pose> found = estimate_rigid_motion(correspondences, {});
  ASSERT_TRUE(found.has_value());
  // 60 exact correspondences against 30 outliers, each of influence (0.001 / 0.05)^2 * 0.05 = 2e-5 (Cauchy).
  EXPECT_LT(log_so3(truth.q.conjugate() * found->q).norm(), 1e-4);
  EXPECT_LT((truth.p - found->p).norm(), 3e-4);
}

/// Of 45 degrees, about axes all around, with a third of outliers.
int count_found_turns(bool is_large) {
  int found = 0;
  for (int i = 0; i < 12; ++i) {
    const double direction = 2.0 * M_PI * i / 12.0;
    const Pose truth{
        exp_so3(0.25 * M_PI * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.3).normalized()),
        {0.05, -0.02, 0.08}};
    std::vector<PointObservation> correspondences = observe(truth, 90);
    for (std::size_t k = 0; k < 30; ++k) correspondences[3 * k].bearing.x() += 0.05;
    const std::optional<Pose> pose =
        estimate_rigid_motion(correspondences, {.confidence = 0.999, .is_large = is_large});
    found += pose && log_so3(truth.q.conjugate() * pose->q).norm() < 1e-3 ? 1 : 0;
  }
  return found;
}

TEST(RigidMotion, EstimatesALargeTurnFromTheDirectionsOfItsSamples) {
  EXPECT_EQ(count_found_turns(true), 12);
  EXPECT_LT(count_found_turns(false), 12);
}

TEST(RigidMotion, NeedsFourCorrespondences) {
  EXPECT_FALSE(estimate_rigid_motion(observe(Pose{}, 3), {}).has_value());
  EXPECT_TRUE(estimate_rigid_motion(observe(Pose{}, 4), {}).has_value());
}

}  // namespace
}  // namespace stillpoint
