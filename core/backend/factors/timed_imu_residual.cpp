// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/timed_imu_residual.h"

#include <algorithm>

#include "core/backend/factors/gravity_direction.h"

namespace stillpoint {
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
