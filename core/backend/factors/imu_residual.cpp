// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/imu_residual.h"

#include <algorithm>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr int kP = ImuErrorIndex::kPosition;
constexpr int kR = ImuErrorIndex::kRotation;
constexpr int kV = ImuErrorIndex::kVelocity;
constexpr int kBg = ImuErrorIndex::kGyroBias;
constexpr int kBa = ImuErrorIndex::kAccelBias;

using PoseJacobian = Eigen::Matrix<double, 15, 7, Eigen::RowMajor>;
using SpeedBiasJacobian = Eigen::Matrix<double, 15, 9, Eigen::RowMajor>;

/// Read-only view of the parameter blocks, and the terms shared by residual and Jacobians.
struct States {
  Eigen::Map<const Eigen::Vector3d> p_i, v_i, bg_i, ba_i, p_j, v_j, bg_j, ba_j;
  Eigen::Quaterniond q_i, q_j;
  Eigen::Matrix3d R_i_t;       ///< R_i transposed
  Eigen::Vector3d delta_p_bi;  ///< R_i^T (p_j - p_i - v_i dt - g dt^2 / 2)
  Eigen::Vector3d delta_v_bi;  ///< R_i^T (v_j - v_i - g dt)
  Eigen::Vector3d rotation;    ///< r_q

  States(double const* const* x, const Preintegration& imu, const Eigen::Vector3d& gravity_w)
      : p_i(x[0]),
        v_i(x[1]),
        bg_i(x[1] + 3),
        ba_i(x[1] + 6),
        p_j(x[2]),
        v_j(x[3]),
        bg_j(x[3] + 3),
        ba_j(x[3] + 6),
        q_i(x[0] + 3),
        q_j(x[2] + 3),
        R_i_t(q_i.toRotationMatrix().transpose()) {
    const double dt = imu.duration_s();
    delta_p_bi = R_i_t * (p_j - p_i - v_i * dt - 0.5 * gravity_w * dt * dt);
    delta_v_bi = R_i_t * (v_j - v_i - gravity_w * dt);
    rotation = log_so3(imu.delta_q(bg_i).conjugate() * (q_i.conjugate() * q_j));
  }
};

PoseJacobian jacobian_pose_i(const States& s) {
  PoseJacobian J = PoseJacobian::Zero();
  J.block<3, 3>(kP, 0) = -s.R_i_t;
  J.block<3, 3>(kP, 3) = skew(s.delta_p_bi);
  J.block<3, 3>(kR, 3) = -right_jacobian_inverse(s.rotation) * (s.q_j.conjugate() * s.q_i).toRotationMatrix();
  J.block<3, 3>(kV, 3) = skew(s.delta_v_bi);
  return J;
}

SpeedBiasJacobian jacobian_speed_bias_i(const States& s, const Preintegration& imu) {
  const Matrix15& D = imu.jacobian();
  const Eigen::Matrix3d dq_dbg = D.block<3, 3>(kR, kBg);
  const Eigen::Vector3d correction = dq_dbg * (s.bg_i - imu.gyro_bias());
  SpeedBiasJacobian J = SpeedBiasJacobian::Zero();
  J.block<3, 3>(kP, 0) = -s.R_i_t * imu.duration_s();
  J.block<3, 3>(kP, 3) = -D.block<3, 3>(kP, kBg);
  J.block<3, 3>(kP, 6) = -D.block<3, 3>(kP, kBa);
  J.block<3, 3>(kR, 3) = -right_jacobian_inverse(s.rotation) * exp_so3(-s.rotation).toRotationMatrix() *
                         right_jacobian(correction) * dq_dbg;
  J.block<3, 3>(kV, 0) = -s.R_i_t;
  J.block<3, 3>(kV, 3) = -D.block<3, 3>(kV, kBg);
  J.block<3, 3>(kV, 6) = -D.block<3, 3>(kV, kBa);
  J.block<3, 3>(kBg, 3).diagonal().setConstant(-1.0);
  J.block<3, 3>(kBa, 6).diagonal().setConstant(-1.0);
  return J;
}

PoseJacobian jacobian_pose_j(const States& s) {
  PoseJacobian J = PoseJacobian::Zero();
  J.block<3, 3>(kP, 0) = s.R_i_t;
  J.block<3, 3>(kR, 3) = right_jacobian_inverse(s.rotation);
  return J;
}

SpeedBiasJacobian jacobian_speed_bias_j(const States& s) {
  SpeedBiasJacobian J = SpeedBiasJacobian::Zero();
  J.block<3, 3>(kV, 0) = s.R_i_t;
  J.block<3, 3>(kBg, 3).setIdentity();
  J.block<3, 3>(kBa, 6).setIdentity();
  return J;
}

}  // namespace

void ImuResidual::evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Preintegration& imu = imu_;
  const States s(parameters, imu, gravity_w_);
  Vector15 r;
  r.segment<3>(kP) = s.delta_p_bi - imu.delta_p(s.bg_i, s.ba_i);
  r.segment<3>(kR) = s.rotation;
  r.segment<3>(kV) = s.delta_v_bi - imu.delta_v(s.bg_i, s.ba_i);
  r.segment<3>(kBg) = s.bg_j - s.bg_i;
  r.segment<3>(kBa) = s.ba_j - s.ba_i;
  const Matrix15& W = imu.sqrt_information();
  Eigen::Map<Vector15>{residuals} = W * r;

  if (jacobians == nullptr) return;
  if (jacobians[0] != nullptr) Eigen::Map<PoseJacobian>{jacobians[0]} = W * jacobian_pose_i(s);
  if (jacobians[1] != nullptr)
    Eigen::Map<SpeedBiasJacobian>{jacobians[1]} = W * jacobian_speed_bias_i(s, imu);
  if (jacobians[2] != nullptr) Eigen::Map<PoseJacobian>{jacobians[2]} = W * jacobian_pose_j(s);
  if (jacobians[3] != nullptr) Eigen::Map<SpeedBiasJacobian>{jacobians[3]} = W * jacobian_speed_bias_j(s);
}

void ImuResidual::evaluate_gravity_jacobian(const double* pose_i, double* jacobian) const {
  const double dt = imu_.duration_s();
  const Eigen::Matrix3d R_i_t = Eigen::Quaterniond(pose_i + 3).toRotationMatrix().transpose();
  const Eigen::Matrix<double, 3, 2> velocity = -dt * R_i_t * gravity_jacobian(gravity_w_);
  Eigen::Matrix<double, 15, 3> J = Eigen::Matrix<double, 15, 3>::Zero();
  J.block<3, 2>(kP, 0) = 0.5 * dt * velocity;
  J.block<3, 2>(kV, 0) = velocity;
  Eigen::Map<Eigen::Matrix<double, 15, 3, Eigen::RowMajor>>{jacobian} = imu_.sqrt_information() * J;
}

namespace {

/// Jacobians of all blocks, of which only some may be wanted.
struct Jacobians {
  Eigen::Matrix<double, 15, 7, Eigen::RowMajor> pose_i, pose_j;
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> speed_bias_i, speed_bias_j;
  Eigen::Matrix<double, 15, 3, Eigen::RowMajor> gravity;
  Vector15 time_offset;

  void copy_to(double** wanted) const {
    if (wanted[0] != nullptr) std::copy_n(pose_i.data(), pose_i.size(), wanted[0]);
    if (wanted[1] != nullptr) std::copy_n(speed_bias_i.data(), speed_bias_i.size(), wanted[1]);
    if (wanted[2] != nullptr) std::copy_n(pose_j.data(), pose_j.size(), wanted[2]);
    if (wanted[3] != nullptr) std::copy_n(speed_bias_j.data(), speed_bias_j.size(), wanted[3]);
    if (wanted[4] != nullptr) std::copy_n(gravity.data(), gravity.size(), wanted[4]);
    if (wanted[5] != nullptr) std::copy_n(time_offset.data(), time_offset.size(), wanted[5]);
  }
};

ExposureShift::PoseJacobian map(Eigen::Matrix<double, 15, 7, Eigen::RowMajor>& J) {
  return ExposureShift::PoseJacobian(J.data());
}
ExposureShift::SpeedBiasJacobian map(Eigen::Matrix<double, 15, 9, Eigen::RowMajor>& J) {
  return ExposureShift::SpeedBiasJacobian(J.data());
}

}  // namespace

void TimedImuResidual::evaluate(double const* const* x, double* residuals, double** jacobians) const {
  if (ends_ != nullptr) {
    evaluate_shifted(x, residuals, jacobians);
    return;
  }
  const ImuResidual residual(imu_, Eigen::Vector3d(x[4]));
  residual.evaluate(x, residuals, jacobians);
  if (jacobians == nullptr) return;
  if (jacobians[4] != nullptr) residual.evaluate_gravity_jacobian(x[0], jacobians[4]);
  if (jacobians[5] != nullptr) std::fill_n(jacobians[5], 15, 0.0);
}

void TimedImuResidual::evaluate_shifted(double const* const* x, double* residuals, double** jacobians) const {
  const Eigen::Vector3d gravity_w(x[4]);
  const ExposureShift shift_i((*ends_)[0], *x[5], {x[0], x[1]}, gravity_w);
  const ExposureShift shift_j((*ends_)[1], *x[5], {x[2], x[3]}, gravity_w);
  const std::array<const double*, 4> shifted = {shift_i.pose(), shift_i.speed_bias(), shift_j.pose(),
                                                shift_j.speed_bias()};
  const ImuResidual residual(imu_, gravity_w);
  if (jacobians == nullptr) {
    residual.evaluate(shifted.data(), residuals, nullptr);
    return;
  }
  Jacobians J;
  std::array<double*, 4> by_state = {J.pose_i.data(), J.speed_bias_i.data(), J.pose_j.data(),
                                     J.speed_bias_j.data()};
  residual.evaluate(shifted.data(), residuals, by_state.data());
  residual.evaluate_gravity_jacobian(shifted[0], J.gravity.data());
  const ExposureShift::GlobalJacobians at_i = shift_i.apply(map(J.pose_i), map(J.speed_bias_i));
  const ExposureShift::GlobalJacobians at_j = shift_j.apply(map(J.pose_j), map(J.speed_bias_j));
  J.time_offset = at_i.time_offset + at_j.time_offset;
  J.gravity.leftCols<2>() += (at_i.gravity + at_j.gravity) * gravity_jacobian(gravity_w);
  J.copy_to(jacobians);
}

}  // namespace stillpoint
