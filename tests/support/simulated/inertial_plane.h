// SPDX-License-Identifier: BSD-3-Clause
/// IMU data for the sliding plane: the camera is the body, moves at constant velocity, and looks
/// horizontally.
#pragma once

#include <vector>

#include "core/config/odometry_config.h"
#include "tests/support/simulated/sliding_plane.h"
#include "tests/support/simulated/visual_config.h"

namespace stillpoint {

/// 2 px per frame of 33.3 ms, at 2 m and a focal length of 150 px.
inline constexpr double kPlaneSpeed_m_per_s = 0.8;

/// Sample at time `t`: no rotation; the specific force is opposite to gravity, which points along camera y.
inline ImuSample plane_imu_at(Timestamp t) {
  return {.t = t, .gyro_b = Eigen::Vector3d::Zero(), .accel_b = {0.0, -9.81, 0.0}};
}

/// Samples at 200 Hz from 0.1 s before the first frame to `seconds` after it.
inline std::vector<ImuSample> plane_imu(double seconds) {
  std::vector<ImuSample> samples;
  for (int i = -20; i <= static_cast<int>(200.0 * seconds); ++i) {
    samples.push_back(plane_imu_at(Timestamp{1'000'000'000 + i * 5'000'000LL}));
  }
  return samples;
}

inline Rig inertial_plane_rig(const SlidingPlane& plane) {
  Rig rig = plane.input().rig;
  rig.has_imu = true;
  return rig;
}

/// Visual-inertial from the first 0.3 s on.
inline OdometryConfig inertial_config(int feedback_lag = 0) {
  OdometryConfig config = visual_config(feedback_lag);
  config.imu.enabled = true;
  config.backend.depth.usage = DepthUsage::kWeighted;
  config.backend.initializer.kind = InitializerKind::kInstant;
  return config;
}

}  // namespace stillpoint
