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

/// T_cj_bi.
struct CameraFromBody {
  CameraFromBody(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera)
      : R(j.R_c_w * i.R_w_b), p(j.R_c_w * (i.p_w_b - j.p_w_b) + camera.p_c_b) {}

  Eigen::Matrix3d R;
  Eigen::Vector3d p;
};

}  // namespace

CameraOnBody::CameraOnBody(const Pose& T_b_c) : R_b_c(T_b_c.R()), p_b_c(T_b_c.p) {
  const Eigen::Matrix3d R_c_b = R_b_c.transpose();
  p_c_b = -(R_c_b * T_b_c.p);
  J_pose_j = tangent_map(Eigen::Matrix3d::Zero(), -R_c_b, p_c_b);
}

CameraInWorld::CameraInWorld(const Pose& T_w_b, const CameraOnBody& camera)
    : R_w_b(T_w_b.R()), p_w_b(T_w_b.p), R_c_w(camera.R_b_c.transpose() * R_w_b.transpose()) {}

void set_pose(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera,
              RelativePoseLinearization& relative) {
  const CameraFromBody T_cj_bi(i, j, camera);
  relative.R_cj_ci = T_cj_bi.R * camera.R_b_c;
  relative.p_cj_ci = T_cj_bi.R * camera.p_b_c + T_cj_bi.p;
}

void set_pose_jacobians(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera,
                        RelativePoseLinearization& relative) {
  const CameraFromBody T_cj_bi(i, j, camera);
  relative.J_pose_i = tangent_map(j.R_c_w, T_cj_bi.R, T_cj_bi.p);
  relative.J_pose_j = camera.J_pose_j;
  relative.J_pose_j.topLeftCorner<3, 3>() = -j.R_c_w;
}

void set_extrinsics_jacobian(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera,
                             RelativePoseLinearization& relative) {
  const CameraFromBody T_cj_bi(i, j, camera);
  // T_b_c enters twice: at the host it moves the point, at j the camera that observes it.
  const Eigen::Matrix3d R_cj_ci = T_cj_bi.R * camera.R_b_c;
  const Eigen::Vector3d p_cj_ci = T_cj_bi.R * camera.p_b_c + T_cj_bi.p;
  relative.J_extrinsics = tangent_map(T_cj_bi.R - camera.R_b_c.transpose(), R_cj_ci, p_cj_ci);
  relative.J_extrinsics.bottomRightCorner<3, 3>() -= Eigen::Matrix3d::Identity();
}

RelativePoseLinearization linearize_relative_pose(const Pose& T_w_bi, const Pose& T_w_bj, const Pose& T_b_c) {
  const CameraOnBody camera(T_b_c);
  const CameraInWorld i(T_w_bi, camera), j(T_w_bj, camera);
  RelativePoseLinearization relative;
  set_pose(i, j, camera, relative);
  set_pose_jacobians(i, j, camera, relative);
  set_extrinsics_jacobian(i, j, camera, relative);
  return relative;
}

}  // namespace stillpoint
