// SPDX-License-Identifier: BSD-3-Clause
/// A smooth path of a body with exact derivatives: what an ideal IMU and an ideal tracker would see.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "core/geometry/pose.h"

namespace stillpoint {

/// Position, attitude and their rates at one moment.
struct BodyMotion {
  Pose T_w_b;
  Eigen::Vector3d velocity_w;      ///< [m/s]
  Eigen::Vector3d acceleration_w;  ///< [m/s^2], without gravity
  Eigen::Vector3d rate_b;          ///< angular rate in the body frame [rad/s]
};

/// Specific force [m/s^2] that an ideal accelerometer measures at `motion`: R_b_w * (a - g).
[[nodiscard]] Eigen::Vector3d specific_force(const BodyMotion& motion);

/// Gravity of the synthetic world [m/s^2], along -z.
inline constexpr double kGravity = 9.81;

/// Weights of the six control points that act at share `u` in [0, 1) of a knot span, for one order of
/// derivative. Uniform quintic B-spline (de Boor 1978); derivatives are per knot span, not per second.
/// @param derivative 0, 1 or 2
[[nodiscard]] std::array<double, 6> quintic_weights(double u, int derivative);

/// Uniform quintic B-spline of position and of the four numbers of a quaternion, which is normalised on use:
/// four times continuously differentiable.
class PathSpline {
 public:
  /// @param start_s    time of the first control point
  /// @param interval_s between control points, > 0
  /// @param positions  at least 6
  /// @param attitudes  as many, unit quaternions T_w_b; signs are made continuous here
  PathSpline(double start_s, double interval_s, std::vector<Eigen::Vector3d> positions,
             std::vector<Eigen::Vector4d> attitudes);

  /// Where all six control points exist [s].
  [[nodiscard]] double first_s() const { return start_s_ + 2.0 * interval_s_; }
  [[nodiscard]] double last_s() const;

  /// @param t_s is held to [first_s, last_s]
  [[nodiscard]] BodyMotion at(double t_s) const;
  /// The same path elsewhere.
  [[nodiscard]] PathSpline shifted(const Eigen::Vector3d& shift_w) const;

  [[nodiscard]] Pose pose_at(double t_s) const { return at(t_s).T_w_b; }

 private:
  double start_s_;
  double interval_s_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector4d> attitudes_;  // x y z w
};

/// The spline whose control points are the poses of `pose_at`, a function of time: follows it closely where
/// it is smooth over a few intervals. Covers [from_s, to_s].
template <class PoseFunction>
[[nodiscard]] PathSpline spline_of(const PoseFunction& pose_at, double from_s, double to_s,
                                   double interval_s) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector4d> attitudes;
  const double start_s = from_s - 3.0 * interval_s;
  for (int i = 0; start_s + (i - 4) * interval_s < to_s; ++i) {
    const Pose pose = pose_at(start_s + i * interval_s);
    positions.push_back(pose.p);
    attitudes.push_back(pose.q.coeffs());
  }
  return {start_s, interval_s, std::move(positions), std::move(attitudes)};
}

}  // namespace stillpoint
