// SPDX-License-Identifier: BSD-3-Clause
/// Simulated smooth motion through a point cloud: exact states, IMU samples and feature tracks.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/so3.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"
#include "tests/support/random.h"

namespace stillpoint {

struct SimulatedMotion {
  double pixel_noise_px = 0.0;
  double depth_noise = 0.0;   ///< standard deviation of 1/depth [1/m]
  double depth_factor = 1.0;  ///< ratio of measured to true depth
  ImuNoise imu_noise{};
  bool noisy_imu = false;
  double time_offset_s = 0.0;       ///< IMU time of a frame minus its timestamp
  int points = 200;                 ///< about half of them are visible
  double ping_pong_period_s = 0.0;  ///< of moving back and forth on the first part of the path; 0 = forward
  double track_length_s = 0.0;      ///< after it a track ends and another one begins; 0 = while it is visible
  std::uint32_t seed = 0;           ///< of all noise
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Constant(0.02);   ///< of noisy_imu; follows its random walk
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Constant(0.05);  ///< likewise
  bool bias_walk = false;                                        ///< else the biases are constant
  double stop_s = 0.0;  ///< from here on the motion slows down, and ends 1 s later; 0 = never

  static Rig rig() {
    Rig rig;
    rig.camera = {.width = 640, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 320.0, .cy = 240.0};
    rig.has_imu = true;
    Eigen::Matrix3d R_b_c;  // camera looks path_time body x, its x to the right (-y), its y down (-z)
    R_b_c << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
    rig.T_b_c = Pose{Eigen::Quaterniond(R_b_c), {0.05, 0.02, -0.01}};
    return rig;
  }

  /// Position and rotation vector, sinusoidal in each component; in motion from t = 0.
  static Eigen::Vector3d position(double t) {
    return {0.4 * std::sin(1.1 * t), 0.3 * std::sin(1.7 * t + 0.5), 0.2 * std::sin(2.3 * t + 1.0)};
  }
  static Eigen::Vector3d angles(double t) {
    return {0.10 * std::sin(1.9 * t), 0.15 * std::sin(1.3 * t + 0.7), 0.25 * std::sin(0.9 * t)};
  }
  static NavState state(double t) {
    constexpr double h = 1e-4;
    NavState s;
    s.t = from_seconds(t);
    s.T_w_b = Pose{exp_so3(angles(t)), position(t)};
    s.v_w = (position(t + h) - position(t - h)) / (2.0 * h);
    return s;
  }

  /// Path parameter (the time argument of `state`) at time t; smooth, with unit rate at mid-path.
  [[nodiscard]] double path_time(double t) const {
    if (stop_s > 0.0 && t > stop_s) {
      const double u = std::min(t - stop_s, 1.0);
      return stop_s + 0.5 * (u + std::sin(M_PI * u) / M_PI);
    }
    const double turn = 2.0 * M_PI / ping_pong_period_s;
    return ping_pong_period_s > 0.0 ? (1.0 + std::sin(turn * t)) / turn : t;
  }

  [[nodiscard]] std::vector<ImuSample> imu(double seconds, double rate_hz = 200.0) const {
    Random random(11 + 7919 * seed);
    const double density = std::sqrt(rate_hz);
    Eigen::Vector3d bg = gyro_bias, ba = accel_bias;
    std::vector<ImuSample> samples;
    for (int i = 0; i <= static_cast<int>(seconds * rate_hz); ++i) {
      constexpr double h = 1e-4;
      const double t = i / rate_hz;
      const double before = path_time(t - h), now = path_time(t), later = path_time(t + h);
      const Eigen::Quaterniond q = exp_so3(angles(now));
      ImuSample sample{.t = from_seconds(t)};
      sample.gyro_b = log_so3(exp_so3(angles(before)).conjugate() * exp_so3(angles(later))) / (2.0 * h);
      const Eigen::Vector3d acceleration =
          (position(later) - 2.0 * position(now) + position(before)) / (h * h);
      sample.accel_b = q.conjugate() * (acceleration + Eigen::Vector3d(0.0, 0.0, 9.81));
      if (noisy_imu) {
        for (int k = 0; k < 3; ++k) {
          sample.gyro_b[k] += imu_noise.gyro_noise * density * random.normal() + bg[k];
          sample.accel_b[k] += imu_noise.accel_noise * density * random.normal() + ba[k];
          if (!bias_walk) continue;
          bg[k] += imu_noise.gyro_walk / density * random.normal();
          ba[k] += imu_noise.accel_walk / density * random.normal();
        }
      }
      samples.push_back(sample);
    }
    return samples;
  }

  /// The frame with timestamp `t`. Feature ids are point indices: a track lasts while its point is visible.
  [[nodiscard]] TrackedFrame frame(std::int64_t id, double t) const {
    Random places(5);
    Random random(static_cast<std::uint32_t>(1000 + id) + 100'003 * seed);
    const Rig calibration = rig();
    const Pose T_c_w = (state(path_time(t + time_offset_s)).T_w_b * calibration.T_b_c).inverse();
    TrackedFrame frame{.id = id, .t = from_seconds(t)};
    for (int k = 0; k < points; ++k) {
      const Eigen::Vector3d p_w = places.uniform3({2.0, -2.5, -2.0}, {5.0, 2.5, 2.0});
      const Eigen::Vector3d p_c = T_c_w * p_w;
      if (p_c.z() < 0.5) continue;
      Eigen::Vector2d pixel = calibration.camera.project(p_c);
      if (!calibration.camera.contains(pixel)) continue;
      pixel += pixel_noise_px * random.normal2();
      TrackedFeature feature{
          .id = track_id(k, t), .pixel = pixel, .bearing = calibration.camera.unproject(pixel)};
      feature.depth = depth_factor / (1.0 / p_c.z() + depth_noise * random.normal());
      frame.features.push_back(feature);
    }
    if (track_length_s > 0.0) std::ranges::sort(frame.features, {}, &TrackedFeature::id);
    return frame;
  }

 private:
  /// The point, or, with tracks of limited length, a number for each of its tracks; they begin at
  /// different times.
  [[nodiscard]] std::int64_t track_id(int point, double t) const {
    if (track_length_s <= 0.0) return point;
    return point + points * static_cast<std::int64_t>(t / track_length_s + std::fmod(0.618 * point, 1.0));
  }
};

}  // namespace stillpoint
