// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/hand_eye.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.h"

namespace stillpoint::eval {
namespace {

/// A pose that moves in three directions and turns about three axes.
Pose wandering(double t) {
  return {exp_so3({0.4 * std::sin(1.3 * t), 0.3 * std::cos(0.9 * t), 0.5 * std::sin(0.4 * t)}),
          {2.0 * std::sin(0.5 * t), 1.5 * std::cos(0.7 * t), 0.3 * std::sin(t)}};
}

const Pose kBody{exp_so3({0.1, -0.7, 1.2}),
                 {0.05, -0.2, 0.1}};  // of the ground truth, in that of the estimate
const Pose kWorld{exp_so3({0.0, 0.3, 2.0}), {5.0, 1.0, -2.0}};

Trajectory truth(double offset_s) {
  Trajectory path;
  for (int i = 0; i <= 3000; ++i) {
    const double t = 0.01 * i;
    path.poses.emplace_back(from_seconds(t + offset_s), kWorld * wandering(t) * kBody);
  }
  return path;
}

Trajectory estimated() {
  Trajectory path;
  for (int i = 50; i < 550; ++i) path.poses.emplace_back(from_seconds(0.05 * i), wandering(0.05 * i));
  return path;
}

TEST(HandEye, FindsBodyTransformAndOffset) {
  const HandEye found = hand_eye(truth(0.137), estimated());
  ASSERT_EQ(found.undetermined, "");
  EXPECT_NEAR(found.offset_s, 0.137, 1e-4);
  EXPECT_LT((found.T_f_g.p - kBody.p).norm(), 1e-3);
  EXPECT_LT(found.T_f_g.q.angularDistance(kBody.q), 1e-3);
  EXPECT_LT(found.position_rmse_m, 1e-3);
}

TEST(HandEye, IsNotDeterminedByRotationAboutOneAxis) {
  Trajectory gt;
  for (int i = 0; i <= 3000; ++i) {
    const double t = 0.01 * i;
    gt.poses.emplace_back(from_seconds(t),
                          Pose{exp_so3({0.0, 0.0, std::sin(t)}), {std::sin(t), std::cos(2.0 * t), 0.0}});
  }
  EXPECT_NE(hand_eye(gt, gt).undetermined.find("fewer than two axes"), std::string::npos);
}

TEST(HandEye, IsNotDeterminedByADistantClock) {
  EXPECT_NE(hand_eye(truth(40.0), estimated()).undetermined, "");
}

}  // namespace
}  // namespace stillpoint::eval
