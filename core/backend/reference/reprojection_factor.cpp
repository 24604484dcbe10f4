// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/reprojection_factor.h"

#include "core/backend/factors/relative_pose_linearization.h"
#include "core/geometry/pose.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

Pose pose_of(const double* x) { return Pose{Eigen::Quaterniond(x + 3), Eigen::Vector3d(x)}; }

/// The landmark transformed from camera i to camera j, scaled by its inverse depth lambda so that it is
/// smooth at infinity and for negative lambda. p_x is the scaled point in frame x.
struct TransferredPoint {
  Pose T_w_bi, T_w_bj, T_b_c;
  double lambda;
  Eigen::Matrix3d R_cj_w;  ///< R_b_c^T R_w_bj^T
  Eigen::Matrix3d R_cj_bi;
  Eigen::Vector3d ray_i;             ///< bearing at the time of state i, z = 1
  Eigen::Vector3d p_bi, p_bj, p_cj;  ///< each times lambda
  Eigen::Vector3d p_cj_ci;           ///< position of camera i in camera j; not scaled

  TransferredPoint(double const* const* x, double inverse_depth, const Eigen::Vector2d& bearing_i)
      : T_w_bi(pose_of(x[0])), T_w_bj(pose_of(x[1])), T_b_c(pose_of(x[2])), lambda(inverse_depth) {
    const Eigen::Matrix3d R_bi = T_w_bi.R();
    const Eigen::Matrix3d R_bj_t = T_w_bj.R().transpose();
    const Eigen::Matrix3d R_bc_t = T_b_c.R().transpose();
    R_cj_w = R_bc_t * R_bj_t;
    R_cj_bi = R_cj_w * R_bi;
    ray_i = bearing_i.homogeneous();
    p_bi = T_b_c.q * ray_i + lambda * T_b_c.p;
    p_bj = R_bj_t * (R_bi * p_bi + lambda * (T_w_bi.p - T_w_bj.p));
    p_cj = R_bc_t * (p_bj - lambda * T_b_c.p);
    p_cj_ci = R_cj_bi * T_b_c.p + R_cj_w * (T_w_bi.p - T_w_bj.p) - R_bc_t * T_b_c.p;
  }
};

using Matrix36 = Eigen::Matrix<double, 3, 6>;

Matrix36 J_point_pose_i(const TransferredPoint& t) {
  Matrix36 J;
  J << t.lambda * t.R_cj_w, -t.R_cj_bi * skew(t.p_bi);
  return J;
}

Matrix36 J_point_pose_j(const TransferredPoint& t) {
  Matrix36 J;
  J << -t.lambda * t.R_cj_w, t.T_b_c.R().transpose() * skew(t.p_bj);
  return J;
}

Matrix36 J_point_extrinsics(const TransferredPoint& t) {
  const Eigen::Matrix3d R_bc = t.T_b_c.R();
  Matrix36 J;
  J << t.lambda * (t.R_cj_bi - R_bc.transpose()), -t.R_cj_bi * R_bc * skew(t.ray_i) + skew(t.p_cj);
  return J;
}

/// Derivatives of the point by pose i, pose j and T_b_c.
using PointJacobians = std::array<Matrix36, 3>;

PointJacobians point_jacobians(const TransferredPoint& t) {
  return {J_point_pose_i(t), J_point_pose_j(t), J_point_extrinsics(t)};
}

/// Same, with the derivative of the relative pose at the `poses`.
PointJacobians point_jacobians_at(const std::array<const double*, 3>& poses, const TransferredPoint& t) {
  const RelativePoseLinearization relative =
      linearize_relative_pose(pose_of(poses[0]), pose_of(poses[1]), pose_of(poses[2]));
  Matrix36 J;
  J << t.lambda * Eigen::Matrix3d::Identity(), -skew(t.p_cj);
  return {J * relative.J_pose_i, J * relative.J_pose_j, J * relative.J_extrinsics};
}

/// One of the two. @param x parameter blocks @param first where the relative pose is linearized, null: at `x`
PointJacobians point_jacobians_at(double const* const* x, const std::array<const double*, 3>& first,
                                  const TransferredPoint& t) {
  if (first == std::array<const double*, 3>{}) return point_jacobians(t);
  return point_jacobians_at({first[0] != nullptr ? first[0] : x[0], first[1] != nullptr ? first[1] : x[1],
                             first[2] != nullptr ? first[2] : x[2]},
                            t);
}

/// Writes d residual / d pose; the tangent space is in the first six of seven columns.
template <int Rows>
void write_pose_jacobian(double* out, const Eigen::Matrix<double, Rows, 3>& J_point,
                         const Matrix36& J_point_pose) {
  Eigen::Map<Eigen::Matrix<double, Rows, 7, Eigen::RowMajor>> J(out);
  J.template leftCols<6>() = J_point * J_point_pose;
  J.col(6).setZero();
}

}  // namespace

template <int Rows>
bool ReprojectionFactor<Rows>::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const ReprojectionMeasurement& m = measurement_;
  const double time_offset = x[3][0];
  const Eigen::Vector4d lens = Eigen::Vector4d(x[4]);
  const Eigen::Vector4d lens_change = lens - m.lens;
  const double noise_ratio = lens_noise_ratio(m.seen_j, lens);
  const Eigen::Vector2d bearing_i = m.bearing_i + corrected_bearing(m.seen_i, lens_change) - m.seen_i -
                                    (time_offset + m.exposure_i_s) * m.velocity_i;
  const Eigen::Vector2d bearing_j = m.bearing_j + corrected_bearing(m.seen_j, lens_change) - m.seen_j -
                                    (time_offset + m.exposure_j_s) * m.velocity_j;
  constexpr std::size_t kLambda = Rows == 3 ? 6 : 5;
  const double inverse_depth_scale = Rows == 3 ? x[5][0] : 1.0;
  const TransferredPoint t(x, x[kLambda][0], bearing_i);
  const ReprojectionRows rows = reprojection_rows(t.p_cj, t.lambda,
                                                  {.bearing = bearing_j,
                                                   .noise_ratio = noise_ratio,
                                                   .inverse_depth = m.inverse_depth_j,
                                                   .inverse_depth_scale = inverse_depth_scale,
                                                   .has_depth = Rows == 3},
                                                  noise_);
  Eigen::Map<Eigen::Matrix<double, Rows, 1>>{residuals} = rows.residual.template head<Rows>();
  const Eigen::Matrix<double, Rows, 3> J_point = rows.J_point.template topRows<Rows>();
  if (jacobians == nullptr) return true;

  const PointJacobians J_poses = point_jacobians_at(x, first_, t);
  for (std::size_t i = 0; i < J_poses.size(); ++i) {
    if (jacobians[i] != nullptr) write_pose_jacobian<Rows>(jacobians[i], J_point, J_poses[i]);
  }
  const Eigen::Matrix<double, Rows, 3> J_ray = J_point * t.R_cj_bi * t.T_b_c.R();
  if (jacobians[3] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Rows, 1>> J(jacobians[3]);
    J = J_ray.template leftCols<2>() * -m.velocity_i;
    J.template head<2>() += m.velocity_j / (noise_ratio * noise_.bearing);
  }
  if (jacobians[4] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Rows, 4, Eigen::RowMajor>> J(jacobians[4]);
    J = J_ray.template leftCols<2>() * lens_jacobian(m.seen_i);
    J.template topRows<2>() -= lens_jacobian(m.seen_j) / (noise_ratio * noise_.bearing) +
                               rows.residual.head<2>() * lens_noise_gradient(m.seen_j) / noise_ratio;
  }
  if (Rows == 3 && jacobians[5] != nullptr) {
    Eigen::Map<Eigen::Vector3d>{jacobians[5]} = rows.J_depth_scale * Eigen::Vector3d::UnitZ();
  }
  if (jacobians[kLambda] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Rows, 1>> J(jacobians[kLambda]);
    J = J_point * t.p_cj_ci;
    if constexpr (Rows == 3) J[2] += rows.J_depth_lambda;
  }
  return true;
}

template class ReprojectionFactor<2>;
template class ReprojectionFactor<3>;

bool HostDepthFactor::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const double inverse_scale = x[0][0];
  const double lambda = x[1][0];
  const BoundedError depth =
      bounded_error((lambda * inverse_scale - measured_) / noise_.inverse_depth, noise_.depth_outlier);
  residuals[0] = depth.value;
  if (jacobians == nullptr) return true;
  const double slope = depth.slope / noise_.inverse_depth;
  if (jacobians[0] != nullptr) jacobians[0][0] = slope * lambda;
  if (jacobians[1] != nullptr) jacobians[1][0] = slope * inverse_scale;
  return true;
}

}  // namespace stillpoint
