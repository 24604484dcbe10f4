// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/schur/frame_transfer.h"

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// (nu, omega) by a tangent whose p shifts the point by `shift`, and whose theta turns it, by `R`, about `p`.
Matrix6 tangent_map(const Eigen::Matrix3d& shift, const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  Matrix6 map;
  map << shift, skew(p) * R, Eigen::Matrix3d::Zero(), R;
  return map;
}

}  // namespace

FrameTransfer frame_transfer(const Pose& T_w_bi, const Pose& T_w_bj, const Pose& T_b_c) {
  const Eigen::Matrix3d R_b_c = T_b_c.R();
  const Eigen::Matrix3d R_c_b = R_b_c.transpose();
  const Eigen::Matrix3d R_cj_w = R_c_b * T_w_bj.R().transpose();
  const Eigen::Matrix3d R_cj_bi = R_cj_w * T_w_bi.R();
  const Eigen::Vector3d p_c_b = -(R_c_b * T_b_c.p);
  const Eigen::Vector3d p_cj_bi = R_cj_w * (T_w_bi.p - T_w_bj.p) + p_c_b;

  FrameTransfer transfer;
  transfer.R_cj_ci = R_cj_bi * R_b_c;
  transfer.p_cj_ci = R_cj_bi * T_b_c.p + p_cj_bi;
  transfer.by_pose_i = tangent_map(R_cj_w, R_cj_bi, p_cj_bi);
  transfer.by_pose_j = tangent_map(-R_cj_w, -R_c_b, p_c_b);
  // The camera moves on both bodies: with the host it carries the point, in j it turns under it.
  transfer.by_extrinsics = tangent_map(R_cj_bi - R_c_b, transfer.R_cj_ci, transfer.p_cj_ci);
  transfer.by_extrinsics.bottomRightCorner<3, 3>() -= Eigen::Matrix3d::Identity();
  return transfer;
}

}  // namespace stillpoint
