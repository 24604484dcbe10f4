// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/relative_pose_linearization.h"

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// d(nu, omega) / d(p, theta): p translates the point by `shift` p, theta rotates it by `R` theta about `p`.
Matrix6 tangent_map(const Eigen::Matrix3d& shift, const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  Matrix6 map;
  map << shift, skew(p) * R, Eigen::Matrix3d::Zero(), R;
  return map;
}

}  // namespace

RelativePoseLinearization linearize_relative_pose(const Pose& T_w_bi, const Pose& T_w_bj, const Pose& T_b_c) {
  const Eigen::Matrix3d R_b_c = T_b_c.R();
  const Eigen::Matrix3d R_c_b = R_b_c.transpose();
  const Eigen::Matrix3d R_cj_w = R_c_b * T_w_bj.R().transpose();
  const Eigen::Matrix3d R_cj_bi = R_cj_w * T_w_bi.R();
  const Eigen::Vector3d p_c_b = -(R_c_b * T_b_c.p);
  const Eigen::Vector3d p_cj_bi = R_cj_w * (T_w_bi.p - T_w_bj.p) + p_c_b;

  RelativePoseLinearization relative;
  relative.R_cj_ci = R_cj_bi * R_b_c;
  relative.p_cj_ci = R_cj_bi * T_b_c.p + p_cj_bi;
  relative.J_pose_i = tangent_map(R_cj_w, R_cj_bi, p_cj_bi);
  relative.J_pose_j = tangent_map(-R_cj_w, -R_c_b, p_c_b);
  // T_b_c enters twice: at the host it moves the point, at j the camera that observes it.
  relative.J_extrinsics = tangent_map(R_cj_bi - R_c_b, relative.R_cj_ci, relative.p_cj_ci);
  relative.J_extrinsics.bottomRightCorner<3, 3>() -= Eigen::Matrix3d::Identity();
  return relative;
}

}  // namespace stillpoint
