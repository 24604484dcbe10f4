// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_error.h"

#include "core/config/monitor_config.h"
#include "core/geometry/covariance.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "core/imu/propagation.h"

namespace stillpoint {
namespace {

bool explains(const Eigen::Vector3d& change, const Eigen::Vector3d& error) {
  return change.dot(error) >= kMonitor.inertial_error.min_cosine * change.norm() * error.norm() &&
         change.norm() >= kMonitor.inertial_error.min_change_ratio * error.norm();
}

/// The motion due to the specific force alone: T_w_b = (dq, dp), v_w = dv. Absent without samples.
std::optional<NavState> preintegrated(Timestamp begin, Timestamp end, const NavState& biases,
                                      ImuBuffer& imu) {
  const std::vector<ImuSample>& samples = imu.samples_up_to(begin, end);
  if (samples.size() < 2) return std::nullopt;
  const NavState start{.t = begin, .gyro_bias = biases.gyro_bias, .accel_bias = biases.accel_bias};
  return propagate(start, samples, Eigen::Vector3d::Zero());
}

/// See `inertial_error`.
struct PreintegratedIntervals {
  Eigen::Vector3d f1, f2;
  Eigen::Quaterniond dq;  ///< dR1 dR2
  double T1, T2;
};

struct ErrorCovariance {
  Eigen::Matrix3d accel;
  Eigen::Matrix3d gyro;
};

/// Of a and w by the errors of the poses.
ErrorCovariance error_covariance(const VisualPoses& poses, const PreintegratedIntervals& imu) {
  using Jacobian = Eigen::Matrix<double, 3, 18>;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const double T = imu.T1 + imu.T2;
  Jacobian accel = Jacobian::Zero(), gyro = Jacobian::Zero();
  accel.middleCols<3>(0) = -I / imu.T1;
  accel.middleCols<3>(3) = -poses.A.T_w_b.R() * skew(imu.f1);
  accel.middleCols<3>(6) = (1.0 / imu.T1 + 1.0 / imu.T2) * I;
  accel.middleCols<3>(9) = -poses.B.T_w_b.R() * skew(imu.f2);
  accel.middleCols<3>(12) = -I / imu.T2;
  accel *= 2.0 / T;
  gyro.middleCols<3>(3) = imu.dq.conjugate().toRotationMatrix() / T;
  gyro.middleCols<3>(15) = -I / T;
  return {propagate(accel, poses.covariance), propagate(gyro, poses.covariance)};
}

}  // namespace

// Inlined, g++ 12 moves the vectors by an instruction that valgrind 3.19 cannot decode, and no instructions
// can be counted.
[[gnu::noinline]] bool InertialError::accel_is_explained() const { return explains(accel_change_w, accel_w); }

[[gnu::noinline]] bool InertialError::gyro_is_explained() const { return explains(gyro_change_b, gyro_b); }

double InertialError::accel_severity() const {
  return accel_w.norm() / (kMonitor.inertial_error.accel + kMonitor.inertial_error.sigmas * accel_sigma);
}

double InertialError::gyro_severity() const {
  return gyro_b.norm() / (kMonitor.inertial_error.gyro + kMonitor.inertial_error.sigmas * gyro_sigma);
}

VisualPoses independent_poses(const VisualPose& A, const VisualPose& B, const VisualPose& C) {
  VisualPoses poses{A, B, C, VisualPoses::Covariance::Zero()};
  poses.covariance.block<6, 6>(0, 0) = A.covariance;
  poses.covariance.block<6, 6>(6, 6) = B.covariance;
  poses.covariance.block<6, 6>(12, 12) = C.covariance;
  return poses;
}

VisualPoses chained_poses(const VisualPose& A, const VisualPose& B, const VisualPose& C) {
  const Eigen::Matrix3d R_A = A.T_w_b.R(), R_B = B.T_w_b.R();
  const Pose T_B_C = B.T_w_b.inverse() * C.T_w_b;
  Eigen::Matrix<double, 18, 6> J1 = Eigen::Matrix<double, 18, 6>::Zero(), J2 = J1;
  J1.block<3, 3>(6, 0) = R_A;
  J1.block<3, 3>(9, 3).setIdentity();
  J1.block<3, 3>(12, 0) = R_A;
  J1.block<3, 3>(12, 3) = -R_B * skew(T_B_C.p);
  J1.block<3, 3>(15, 3) = T_B_C.R().transpose();
  J2.block<3, 3>(12, 0) = R_B;
  J2.block<3, 3>(15, 3).setIdentity();
  return {A, B, C, propagate(J1, B.covariance) + propagate(J2, C.covariance)};
}

std::optional<InertialError> inertial_error(const VisualPoses& poses, const NavState& state,
                                            const Eigen::Vector3d& gravity_w, ImuBuffer& imu) {
  const VisualPose &A = poses.A, &B = poses.B, &C = poses.C;
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
  const ErrorCovariance covariance =
      error_covariance(poses, {.f1 = dv1 - dp1 / T1, .f2 = dp2 / T2, .dq = dq1 * dq2, .T1 = T1, .T2 = T2});
  return InertialError{
      .accel_w = (v_1 - v_2) * 2.0 / T,
      .gyro_b = log_so3(C.T_w_b.q.conjugate() * (A.T_w_b.q * dq1 * dq2)) / T,
      .accel_sigma = largest_sigma(covariance.accel),
      .gyro_sigma = largest_sigma(covariance.gyro),
      .accel_change_w = B.T_w_b.q * Eigen::Vector3d(dv2 / T2) - A.T_w_b.q * Eigen::Vector3d(dv1 / T1),
      .gyro_change_b = log_so3(dq2) / T2 - log_so3(dq1) / T1};
}

}  // namespace stillpoint
