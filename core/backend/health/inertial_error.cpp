// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_error.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.h"
#include "core/imu/propagation.h"

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

/// The motion due to the specific force alone: T_w_b = (dq, dp), v_w = dv. Absent without samples.
std::optional<NavState> preintegrated(Timestamp begin, Timestamp end, const NavState& biases,
                                      ImuBuffer& imu) {
  const std::vector<ImuSample>& samples = imu.samples_up_to(begin, end);
  if (samples.size() < 2) return std::nullopt;
  const NavState start{.t = begin, .gyro_bias = biases.gyro_bias, .accel_bias = biases.accel_bias};
  return propagate(start, samples, Eigen::Vector3d::Zero());
}

}  // namespace

// Inlined, g++ 12 moves the vectors by an instruction that valgrind 3.19 cannot decode, and no instructions
// can be counted.
[[gnu::noinline]] bool InertialError::accel_is_explained() const { return explains(accel_change_w, accel_w); }

[[gnu::noinline]] bool InertialError::gyro_is_explained() const { return explains(gyro_change_b, gyro_b); }

double InertialError::severity() const {
  return std::max(accel_w.norm() / (kMaxAccelError + kSigmas * accel_sigma),
                  gyro_b.norm() / (kMaxGyroError + kSigmas * gyro_sigma));
}

std::optional<InertialError> inertial_error(const VisualPoses& poses, const NavState& state,
                                            const Eigen::Vector3d& gravity_w, ImuBuffer& imu) {
  const auto& [A, B, C] = poses;
  const std::optional<NavState> ab = preintegrated(A.t, B.t, state, imu);
  const std::optional<NavState> bc = preintegrated(B.t, C.t, state, imu);
  if (!ab || !bc) return std::nullopt;
  const double T1 = seconds_between(A.t, B.t), T2 = seconds_between(B.t, C.t);
  const auto& [dq1, dp1] = ab->T_w_b;
  const auto& [dq2, dp2] = bc->T_w_b;
  const Eigen::Vector3d &dv1 = ab->v_w, &dv2 = bc->v_w;
  const Eigen::Vector3d v_1 =
      (B.T_w_b.p - A.T_w_b.p) / T1 + 0.5 * T1 * gravity_w + A.T_w_b.q * Eigen::Vector3d(dv1 - dp1 / T1);
  const Eigen::Vector3d v_2 =
      (C.T_w_b.p - B.T_w_b.p) / T2 - 0.5 * T2 * gravity_w - B.T_w_b.q * Eigen::Vector3d(dp2 / T2);
  const double T = T1 + T2;
  const double sigma_m = std::max({A.sigma_m, B.sigma_m, C.sigma_m});
  const double sigma_rad = std::max(A.sigma_rad, C.sigma_rad);
  return InertialError{
      .accel_w = (v_1 - v_2) * 2.0 / T,
      .gyro_b = log_so3(C.T_w_b.q.conjugate() * (A.T_w_b.q * dq1 * dq2)) / T,
      .accel_sigma = 2.0 * sigma_m * std::sqrt(2.0 / (T1 * T1) + 2.0 / (T2 * T2)) / T,
      .gyro_sigma = sigma_rad * std::sqrt(2.0) / T,
      .accel_change_w = B.T_w_b.q * Eigen::Vector3d(dv2 / T2) - A.T_w_b.q * Eigen::Vector3d(dv1 / T1),
      .gyro_change_b = log_so3(dq2) / T2 - log_so3(dq1) / T1};
}

}  // namespace stillpoint
