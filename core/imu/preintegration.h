// SPDX-License-Identifier: BSD-3-Clause
/// Midpoint preintegration of inertial samples between two times, and the gyro bias from rotations measured
/// by another sensor. Paper Sec. II; Qin et al. 2018 (VINS-Mono), Sec. IV-B and V-B1; Forster et al. 2017.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"

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

/// Preintegrated motion of the body from time i to time j, independent of gravity and of the state at i.
///
/// State at j from the state at i, with T = t_j - t_i and gravity g in the world (`predict`):
///
///   q_j = q_i delta_q,    v_j = v_i + g T + q_i delta_v,    p_j = p_i + v_i T + 1/2 g T^2 + q_i delta_p.
///
/// Recursion over the samples (w_k, a_k), from identity and zero, with dt = t_(k+1) - t_k and biases b_g,
/// b_a:
///
///   theta   = (1/2 (w_k + w_(k+1)) - b_g) dt
///   delta_q' = delta_q Exp(theta)
///   f       = 1/2 (delta_q (a_k - b_a) + delta_q' (a_(k+1) - b_a))
///   delta_p' = delta_p + delta_v dt + 1/2 f dt^2
///   delta_v' = delta_v + f dt.
///
/// Error state e = (dp, dtheta, dv, db_g, db_a), rotation on the right (R Exp(dtheta)). With R, R' the
/// rotations before and after the step and [.]x the skew matrix, e' = F e + noise, where
///
///   F_qq = R'^T R,              F_qbg = -J_r(theta) dt        (J_r: right Jacobian of SO(3))
///   F_vq = -dt/2 (R [a_k - b_a]x + R' [a_(k+1) - b_a]x F_qq)
///   F_vbg = -dt/2 R' [a_(k+1) - b_a]x F_qbg,    F_vba = -dt/2 (R + R')
///   F_pv = dt I,                F_px = dt/2 F_vx  (x = q, bg, ba),
///
/// and the remaining diagonal blocks are identity. Covariance and Jacobian are propagated by
///
///   P' = F (P + N) F^T + W,    J' = F J,    P = 0, J = I at i.
///
/// N = diag(0, 0, 0, s_g^2 / dt, s_a^2 / dt) is the white noise (densities s_g, s_a), which acts like a bias
/// during the step and enters the p, theta and v rows only; W = diag(0, 0, 0, s_wg^2 dt, s_wa^2 dt) is the
/// random walk of the biases. Over a single step P is singular, because the errors of position and velocity
/// are proportional; for its inverse s_a^2 dt^3 / 12 is added to the variance of the position, which then is
/// s_a^2 dt^3 / 3 as for continuous white noise. A later change of the biases is applied to first order by
/// the bias columns of J:
///
///   delta_p(b) = delta_p + J_pbg (b_g - b_g0) + J_pba (b_a - b_a0),    same for delta_v,
///   delta_q(b) = delta_q Exp(J_qbg (b_g - b_g0)),
///
/// where b_g0, b_a0, the linearization point, are the biases of the integration.
class Preintegration {
 public:
  /// @param noise per sqrt(Hz), from which the covariance is propagated
  /// @param gyro_bias, accel_bias linearization point
  /// @param recycled storage for the samples; its content is ignored
  Preintegration(const ImuNoise& noise, const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias,
                 std::vector<ImuSample> recycled = {});

  /// Adds the samples of one interval, sorted by time, from i to j (see `ImuBuffer::samples_between`).
  /// Further calls extend the interval: their first sample must have the time of the last one so far and is
  /// not added again. Fewer than two samples add no motion.
  void integrate(const std::vector<ImuSample>& samples);

  /// Extends the interval by a later one, with the larger noise of both.
  void append(const Preintegration& later);

  /// Reintegrates all samples with another noise, for samples that turn out to be unreliable.
  void set_noise(const ImuNoise& noise);

  /// Reintegrates all samples with other biases; for changes too large for the first-order correction.
  void repropagate(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias);

  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] const std::vector<ImuSample>& samples() const { return samples_; }
  /// Moves the samples out, for reuse of their storage; the object must not be used afterwards.
  [[nodiscard]] std::vector<ImuSample> release_samples() { return std::move(samples_); }
  [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return gyro_bias_; }    ///< linearization point
  [[nodiscard]] const Eigen::Vector3d& accel_bias() const { return accel_bias_; }  ///< linearization point
  [[nodiscard]] const Matrix15& covariance() const { return covariance_; }  ///< of (p, theta, v, bg, ba)
  /// Lower triangular W with W^T W = inverse of the covariance; valid for a positive duration. Zero, that is,
  /// no information, if the covariance is singular (noise densities of zero).
  [[nodiscard]] const Matrix15& sqrt_information() const { return sqrt_information_; }
  /// J = d e_j / d e_i; columns 9..14 correct the deltas for changed biases.
  [[nodiscard]] const Matrix15& jacobian() const { return jacobian_; }

  /// Deltas corrected to first order for the given biases.
  [[nodiscard]] Eigen::Vector3d delta_p(const Eigen::Vector3d& gyro_bias,
                                        const Eigen::Vector3d& accel_bias) const;
  [[nodiscard]] Eigen::Vector3d delta_v(const Eigen::Vector3d& gyro_bias,
                                        const Eigen::Vector3d& accel_bias) const;
  [[nodiscard]] Eigen::Quaterniond delta_q(const Eigen::Vector3d& gyro_bias) const;

  /// State at j from the state at i.
  /// @param state_i its biases correct the deltas and are kept
  /// @param gravity_w e.g. (0, 0, -9.81) [m/s^2]
  [[nodiscard]] NavState predict(const NavState& state_i, const Eigen::Vector3d& gravity_w) const;

 private:
  void reset(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias);
  void step(const ImuSample& from, const ImuSample& to);
  void finalize();

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

/// An interval of inertial data and the rotation of the body over it from another source (vision, ground
/// truth).
struct RotationPair {
  const Preintegration* preintegration;  ///< not owned, never null
  Eigen::Quaterniond q_bi_bj;
};

/// Gyro bias [rad/s] by linear least squares over the rotation differences of all intervals,
///
///   min_b sum | Log(delta_q(b_0)^-1 q_bi_bj) - J (b - b_0) |^2,    J = d theta / d b_g,
///
/// with b_0 the linearization point of each preintegration. For biases of a few 0.01 rad/s iterate once:
/// repropagate with the result and estimate again.
///
/// @param pairs at least one, of positive duration
[[nodiscard]] Eigen::Vector3d estimate_gyro_bias(std::span<const RotationPair> pairs);

}  // namespace stillpoint
