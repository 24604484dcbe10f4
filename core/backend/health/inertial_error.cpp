// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/so3.h"
#include "core/imu/preintegration.h"

namespace stillpoint {
namespace {

constexpr double kMaxAccelError = 3.0;  // [m/s^2]
constexpr double kMaxGyroError = 0.1;   // [rad/s]
constexpr double kSigmas = 4.0;
constexpr double kMinCosine = 0.7;
constexpr double kMinChangeRatio = 0.4;

bool explains(const Eigen::Vector3d& change, const Eigen::Vector3d& error) {
  return change.dot(error) >= kMinCosine * change.norm() * error.norm() &&
         change.norm() >= kMinChangeRatio * error.norm();
}

}  // namespace

bool InertialError::is_explained() const {
  return explains(accel_change_w, accel_w) || explains(gyro_change_b, gyro_b);
}

double InertialError::severity() const {
  return std::max(accel_w.norm() / (kMaxAccelError + kSigmas * accel_sigma),
                  gyro_b.norm() / (kMaxGyroError + kSigmas * gyro_sigma));
}

std::optional<InertialError> InertialComparison::compare(const Poses& poses, const NavState& state,
                                                         const Eigen::Vector3d& gravity_w, ImuBuffer& imu) {
  const auto& [A, B, C] = poses;
  Preintegration ab({}, state.gyro_bias, state.accel_bias, std::move(first_samples_));
  Preintegration bc({}, state.gyro_bias, state.accel_bias, std::move(second_samples_));
  ab.integrate(imu.samples_up_to(A.t, B.t));
  bc.integrate(imu.samples_up_to(B.t, C.t));
  const double T1 = ab.duration_s(), T2 = bc.duration_s();
  const Eigen::Vector3d dp1 = ab.delta_p(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d dv1 = ab.delta_v(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d dp2 = bc.delta_p(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d dv2 = bc.delta_v(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d v_1 =
      (B.T_w_b.p - A.T_w_b.p) / T1 + 0.5 * T1 * gravity_w + A.T_w_b.q * Eigen::Vector3d(dv1 - dp1 / T1);
  const Eigen::Vector3d v_2 =
      (C.T_w_b.p - B.T_w_b.p) / T2 - 0.5 * T2 * gravity_w - B.T_w_b.q * Eigen::Vector3d(dp2 / T2);
  const double T = T1 + T2;
  const Eigen::Quaterniond dq1 = ab.delta_q(state.gyro_bias), dq2 = bc.delta_q(state.gyro_bias);
  const double sigma_m = std::max({A.sigma_m, B.sigma_m, C.sigma_m});
  const double sigma_rad = std::max(A.sigma_rad, C.sigma_rad);
  first_samples_ = ab.release_samples();
  second_samples_ = bc.release_samples();
  if (T1 <= 0.0 || T2 <= 0.0) return std::nullopt;
  return InertialError{
      .accel_w = (v_1 - v_2) * 2.0 / T,
      .gyro_b = log_so3(C.T_w_b.q.conjugate() * (A.T_w_b.q * dq1 * dq2)) / T,
      .accel_sigma = 2.0 * sigma_m * std::sqrt(2.0 / (T1 * T1) + 2.0 / (T2 * T2)) / T,
      .gyro_sigma = sigma_rad * std::sqrt(2.0) / T,
      .accel_change_w = B.T_w_b.q * Eigen::Vector3d(dv2 / T2) - A.T_w_b.q * Eigen::Vector3d(dv1 / T1),
      .gyro_change_b = log_so3(dq2) / T2 - log_so3(dq1) / T1};
}

}  // namespace stillpoint
