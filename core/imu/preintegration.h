// SPDX-License-Identifier: BSD-3-Clause
/// Midpoint preintegration of inertial samples between two moments. Paper Sec. II; Qin et al. 2018
/// (VINS-Mono), Sec. IV-B; Forster et al. 2017.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "core/types/imu_sample.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// Order of the 15 error states in covariance and residual: position, rotation, velocity, gyro bias, accel
/// bias.
struct ImuErrorIndex {
  static constexpr int kPosition = 0;
  static constexpr int kRotation = 3;
  static constexpr int kVelocity = 6;
  static constexpr int kGyroBias = 9;
  static constexpr int kAccelBias = 12;
};
using Matrix15 = Eigen::Matrix<double, 15, 15>;
using Vector15 = Eigen::Matrix<double, 15, 1>;

/// Relative motion of the body from moment i to moment j as the IMU saw it, free of gravity and of the start
/// state.
class Preintegration {
 public:
  /// @param memory for the samples: a list that nobody needs any more
  Preintegration(const ImuNoise& noise, const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias,
                 std::vector<ImuSample> memory = {});

  /// Adds samples of one interval: they must start at i and end at j (see `samples_between`), rising in time.
  /// A second call continues where the first ended: its first sample is at the time of the last one before
  /// (and is not kept: it is that one). Fewer than two samples add nothing to the motion.
  void integrate(const std::vector<ImuSample>& samples);

  /// Integrates all samples again with other biases; for changes too large for the first-order correction.
  void repropagate(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias);

  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] const std::vector<ImuSample>& samples() const { return samples_; }
  /// Gives them up, with their memory: the last call.
  [[nodiscard]] std::vector<ImuSample> take_samples() { return std::move(samples_); }
  [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return gyro_bias_; }    ///< linearisation point
  [[nodiscard]] const Eigen::Vector3d& accel_bias() const { return accel_bias_; }  ///< linearisation point
  [[nodiscard]] const Matrix15& covariance() const { return covariance_; }  ///< of (p, theta, v, bg, ba)
  /// Lower triangular W with W^T W = inverse of the covariance; valid once a positive time has passed.
  [[nodiscard]] const Matrix15& sqrt_information() const { return sqrt_information_; }
  /// d (p, theta, v, bg, ba) at j / d the same at i, first order; columns 9..14 correct the deltas for
  /// biases.
  [[nodiscard]] const Matrix15& jacobian() const { return jacobian_; }

  /// Deltas corrected to first order for other biases.
  [[nodiscard]] Eigen::Vector3d delta_p(const Eigen::Vector3d& gyro_bias,
                                        const Eigen::Vector3d& accel_bias) const;
  [[nodiscard]] Eigen::Vector3d delta_v(const Eigen::Vector3d& gyro_bias,
                                        const Eigen::Vector3d& accel_bias) const;
  [[nodiscard]] Eigen::Quaterniond delta_q(const Eigen::Vector3d& gyro_bias) const;

  /// State at j from the state at i. @param gravity_w e.g. (0, 0, -9.81) [m/s^2]
  [[nodiscard]] NavState predict(const NavState& state_i, const Eigen::Vector3d& gravity_w) const;

 private:
  void reset(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias);
  void step(const ImuSample& from, const ImuSample& to);
  void complete();

  ImuNoise noise_;
  std::vector<ImuSample> samples_;
  Eigen::Vector3d gyro_bias_;
  Eigen::Vector3d accel_bias_;
  double duration_s_ = 0.0;
  Eigen::Vector3d delta_p_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d delta_v_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond delta_q_ = Eigen::Quaterniond::Identity();
  Matrix15 covariance_ = Matrix15::Zero();
  Matrix15 jacobian_ = Matrix15::Identity();
  Matrix15 sqrt_information_ = Matrix15::Zero();
};

}  // namespace stillpoint
