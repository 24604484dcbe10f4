// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/online_calibration.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

BackendConfig bounded_config() {
  BackendConfig config;
  config.time_offset_bound_s = 0.1;
  config.extrinsics_bound_m = 0.05;
  config.extrinsics_bound_rad = 0.1;
  config.depth.scale_bound = 0.3;
  return config;
}

TEST(CalibrationBounds, LeaveAPlausibleCalibrationUnchanged) {
  Rig rig;
  rig.time_offset_s = 0.02;
  Window window;
  window.time_offset_s = 0.119;
  window.T_b_c = Pose{exp_so3({0.0, 0.09, 0.0}), {0.03, 0.03, 0.0}};
  window.depth_scale = 0.71;
  const Window before = window;
  const CalibrationAtBound at_bound = limit_calibration(rig, bounded_config(), window);
  EXPECT_FALSE(at_bound.time_offset || at_bound.extrinsics || at_bound.depth_scale);
  EXPECT_EQ(window.time_offset_s, before.time_offset_s);
  EXPECT_EQ(window.T_b_c.p, before.T_b_c.p);
  EXPECT_EQ(window.T_b_c.q.coeffs(), before.T_b_c.q.coeffs());
  EXPECT_EQ(window.depth_scale, before.depth_scale);
}

TEST(CalibrationBounds, LimitTheDeviationFromTheRig) {
  Rig rig;
  rig.T_b_c = Pose{exp_so3({0.3, 0.0, 0.0}), {0.1, 0.0, 0.0}};
  rig.time_offset_s = 0.02;
  Window window;
  window.time_offset_s = -0.32;
  window.T_b_c = Pose{rig.T_b_c.q * exp_so3({0.0, 0.2, 0.0}), {0.1, 0.3, 0.4}};
  window.depth_scale = 1.5;
  const CalibrationAtBound at_bound = limit_calibration(rig, bounded_config(), window);
  EXPECT_TRUE(at_bound.time_offset && at_bound.extrinsics && at_bound.depth_scale);
  EXPECT_DOUBLE_EQ(window.time_offset_s, -0.08);
  EXPECT_LT((window.T_b_c.p - Eigen::Vector3d(0.1, 0.03, 0.04)).norm(), 1e-12);  // 0.05 of (0.3, 0.4)
  EXPECT_NEAR(window.T_b_c.q.angularDistance(rig.T_b_c.q), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(window.depth_scale, 1.3);
}

}  // namespace
}  // namespace stillpoint
