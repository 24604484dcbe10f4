// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/exposure_shift.h"

#include "core/geometry/so3.h"

namespace stillpoint {

ExposureShift::ExposureShift(const ImuEnd& end, double time_offset_s, StateBlocks state,
                             const Eigen::Vector3d& gravity_w)
    : d_(time_offset_s - end.time_offset_s),
      R_(Eigen::Quaterniond(state.pose + 3).toRotationMatrix()),
      rate_b_(end.gyro_b - Eigen::Vector3d(state.speed_bias + 3)),
      force_b_(end.accel_b - Eigen::Vector3d(state.speed_bias + 6)),
      acceleration_(R_ * force_b_ + gravity_w),
      speed_bias_(state.speed_bias) {
  const Eigen::Vector3d v(state.speed_bias);
  pose_.head<3>() = Eigen::Vector3d(state.pose) - d_ * v + 0.5 * d_ * d_ * acceleration_;
  pose_.tail<4>() = (Eigen::Quaterniond(state.pose + 3) * exp_so3(-d_ * rate_b_)).coeffs();
  speed_bias_.head<3>() = v - d_ * acceleration_;
}

ExposureShift::GlobalJacobians ExposureShift::apply(PoseJacobian J_pose,
                                                    SpeedBiasJacobian J_speed_bias) const {
  using Block = Eigen::Matrix<double, 15, 3>;
  const Block position = J_pose.leftCols<3>();
  const Block rotation = J_pose.middleCols<3>(3);
  const Block velocity = J_speed_bias.leftCols<3>();
  const Block by_force = d_ * velocity - 0.5 * d_ * d_ * position;

  GlobalJacobians globals;
  globals.time_offset = -position * speed_bias_.head<3>() - rotation * rate_b_ - velocity * acceleration_;
  globals.gravity = -by_force;
  J_pose.middleCols<3>(3) =
      rotation * exp_so3(d_ * rate_b_).toRotationMatrix() + by_force * R_ * skew(force_b_);
  J_speed_bias.leftCols<3>() = velocity - d_ * position;
  J_speed_bias.middleCols<3>(3) += d_ * rotation * right_jacobian(-d_ * rate_b_);
  J_speed_bias.rightCols<3>() += by_force * R_;
  return globals;
}

}  // namespace stillpoint
