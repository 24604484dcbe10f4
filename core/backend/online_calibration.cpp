// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/online_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kAveragingHalfWidth_s = 0.02;  // as far as samples are available after the newest exposure

/// Limits `value` to [center - bound, center + bound]. @return whether it was outside
bool clamp_around(double center, double bound, double& value) {
  const double limited = std::clamp(value, center - bound, center + bound);
  const bool at_bound = limited != value;
  value = limited;
  return at_bound;
}

/// @return whether either part was outside of its bound
bool limit_extrinsics(const Pose& calibrated, const BackendConfig& config, Pose& T_b_c) {
  const Eigen::Vector3d translation = T_b_c.p - calibrated.p;
  const Eigen::Vector3d rotation = log_so3(calibrated.q.conjugate() * T_b_c.q);
  const bool translated = translation.norm() > config.extrinsics_bound_m;
  const bool rotated = rotation.norm() > config.extrinsics_bound_rad;
  if (translated) T_b_c.p = calibrated.p + config.extrinsics_bound_m * translation.normalized();
  if (rotated) T_b_c.q = calibrated.q * exp_so3(config.extrinsics_bound_rad * rotation.normalized());
  return translated || rotated;
}

}  // namespace

void average_imu_at_exposure(const ImuBuffer& imu, WindowFrame& frame) {
  const Timestamp exposure = after(frame.state.t, frame.time_offset_s);
  const std::optional<ImuSample> mean = imu.mean_around(exposure, kAveragingHalfWidth_s);
  if (!mean) return;
  frame.gyro_b = mean->gyro_b;
  frame.accel_b = mean->accel_b;
}

void add_calibration_walk(const BackendConfig& config, const AgreesWithRig& agrees, double seconds,
                          LinearPrior& prior) {
  const double root = std::sqrt(seconds);
  const double m = root * config.extrinsics_walk_m;
  const double rad = root * config.extrinsics_walk_rad;
  add_random_step(BlockKind::kTimeOffset, std::array{root * config.time_offset_walk}, prior);
  if (!agrees.extrinsics) add_random_step(BlockKind::kExtrinsics, std::array{m, m, m, rad, rad, rad}, prior);
  if (!agrees.depth_scale)
    add_random_step(BlockKind::kDepthScale, std::array{root * config.depth.scale_walk}, prior);
}

CalibrationAtBound limit_calibration(const Rig& rig, const BackendConfig& config, Window& window) {
  return {.time_offset = clamp_around(rig.time_offset_s, config.time_offset_bound_s, window.time_offset_s),
          .extrinsics = limit_extrinsics(rig.T_b_c, config, window.T_b_c),
          .depth_scale = clamp_around(1.0, config.depth.scale_bound, window.depth_scale)};
}

}  // namespace stillpoint
