// SPDX-License-Identifier: BSD-3-Clause
/// Smooth path of a body with exact derivatives, the source of ground-truth poses and ideal IMU samples; and
/// the measurement model of an IMU on it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"
#include "core/types/rig.h"
#include "datasets/io/imu_file.h"

namespace stillpoint::synth {

/// Pose and its derivatives at one time.
struct BodyMotion {
  Pose T_w_b;
  Eigen::Vector3d velocity_w = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration_w = Eigen::Vector3d::Zero();  ///< [m/s^2], without gravity
  Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();          ///< angular rate in the body frame [rad/s]
};

/// Specific force [m/s^2] that an ideal accelerometer measures at `motion`: R_b_w * (a - g).
[[nodiscard]] Eigen::Vector3d specific_force(const BodyMotion& motion);

/// Gravity of the synthetic world [m/s^2], along -z.
inline constexpr double kGravity = 9.81;

/// Weights w_k of a uniform quintic B-spline (de Boor 1978), x(u) = sum_{k=0}^{5} w_k(u) c_{i+k}, at `u` in
/// [0, 1) of knot span i, for one order of derivative. Derivatives are per knot span, not per second.
/// @param derivative 0, 1 or 2
[[nodiscard]] std::array<double, 6> quintic_weights(double u, int derivative);

/// Uniform quintic B-spline of the position p and the four components r of a quaternion, normalized on
/// evaluation: q = r / |r|. Four times continuously differentiable. Angular rate: w_b = 2 vec(q^-1 dq/dt).
class PathSpline {
 public:
  /// @param start_s    time of the first control point
  /// @param interval_s between control points, > 0
  /// @param positions  at least 6
  /// @param attitudes  same size, unit quaternions of T_w_b; signs are made continuous
  PathSpline(double start_s, double interval_s, std::vector<Eigen::Vector3d> positions,
             std::vector<Eigen::Vector4d> attitudes);

  /// Valid interval [s]: all six control points exist.
  [[nodiscard]] double first_s() const { return start_s_ + 2.0 * interval_s_; }
  [[nodiscard]] double last_s() const;

  /// @param t_s clamped to [first_s, last_s]
  [[nodiscard]] BodyMotion at(double t_s) const;
  /// The path translated by `shift_w`.
  [[nodiscard]] PathSpline shifted(const Eigen::Vector3d& shift_w) const;
  /// The path in another world frame v.
  [[nodiscard]] PathSpline transformed(const Pose& T_v_w) const;

  [[nodiscard]] Pose pose_at(double t_s) const { return at(t_s).T_w_b; }

 private:
  double start_s_;
  double interval_s_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector4d> attitudes_;  // x y z w
};

/// Spline over [from_s, to_s] with control points sampled from `pose_at`, a function of time. Approximates it
/// well where it is smooth over a few intervals.
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

/// Parameters of a simulated path of the body that carries a camera.
struct PathRequest {
  Pose T_b_c;              ///< camera in the body frame
  std::uint64_t seed = 1;  ///< of all random choices
  double from_s = 0.0;     ///< first and last path time
  double to_s = 0.0;
};

/// White noise and random-walk bias (IEEE Std 952; Woodman 2007). With the sample interval dt,
///
///   z_k = x_k + b_k + density / sqrt(dt) * n_k,   b_{k+1} = b_k + walk * sqrt(dt) * m_k,   n, m ~ N(0, I)
///
/// x: true angular rate or specific force. The default densities are those of the OpenLORIS packages for a
/// RealSense D435i (Bosch BMI055).
struct ImuSensor {
  double gyro_rate_hz = 400.0;
  double accel_rate_hz = 250.0;
  ImuNoise noise{.gyro_noise = 1.8e-4, .accel_noise = 2.5e-3, .gyro_walk = 2e-5, .accel_walk = 2e-4};
  double gyro_bias = 0.003;    ///< standard deviation per axis of the initial bias [rad/s]
  double accel_bias = 0.03;    ///< the same for the accelerometer [m/s^2]
  double time_offset_s = 0.0;  ///< IMU timestamp minus true time
};

struct ImuRecord {
  std::vector<datasets::VectorSample> gyro;   ///< [rad/s]
  std::vector<datasets::VectorSample> accel;  ///< [m/s^2]
};

struct ImuInterval {
  Timestamp epoch;      ///< timestamp of path time 0
  double from_s = 0.0;  ///< in path time
  double to_s = 0.0;
  std::uint64_t seed = 1;
};

/// Samples over an interval; gyroscope and accelerometer have separate rates and phases.
[[nodiscard]] ImuRecord simulate_imu(const PathSpline& path, const ImuSensor& sensor,
                                     const ImuInterval& interval);

}  // namespace stillpoint::synth
