// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/calibration_factors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

using Matrix36 = Eigen::Matrix<double, 3, 6>;

Pose pose_of(const double* x) { return Pose{Eigen::Quaterniond(x + 3), Eigen::Vector3d(x)}; }

/// A landmark in the camera frame, and its derivatives.
struct PointInCamera {
  Pose T_w_b, T_b_c;
  Eigen::Vector3d p_b, p_c;

  PointInCamera(const double* pose, const double* extrinsics, const double* point)
      : T_w_b(pose_of(pose)),
        T_b_c(pose_of(extrinsics)),
        p_b(T_w_b.q.conjugate() * (Eigen::Vector3d(point) - T_w_b.p)),
        p_c(T_b_c.q.conjugate() * (p_b - T_b_c.p)) {}

  [[nodiscard]] Eigen::Matrix3d J_point() const { return (T_w_b.R() * T_b_c.R()).transpose(); }
  [[nodiscard]] Matrix36 J_pose() const {
    Matrix36 J;
    J << -J_point(), T_b_c.R().transpose() * skew(p_b);
    return J;
  }
  [[nodiscard]] Matrix36 J_extrinsics() const {
    Matrix36 J;
    J << -T_b_c.R().transpose(), skew(p_c);
    return J;
  }
};

/// Writes a Jacobian by a pose; the tangent space is in the first six of seven columns.
template <int Rows>
void write_by_pose(double* out, const Eigen::Matrix<double, Rows, 6>& J) {
  if (out == nullptr) return;
  for (int row = 0; row < Rows; ++row) {
    for (int column = 0; column < 6; ++column) out[7 * row + column] = J(row, column);
    out[7 * row + 6] = 0.0;
  }
}

/// Distorted normalized coordinates, and their derivatives.
struct DistortedPoint {
  Eigen::Vector2d m;        ///< (x_d, y_d)
  Eigen::Matrix2d J_plane;  ///< by the undistorted coordinates
  Eigen::Matrix<double, 2, 8> J_coefficients;
};

/// Equations in core/geometry/camera.h.
DistortedPoint radial_tangential(const double* k, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  const double denominator = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double radial = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / denominator;
  const double slope =
      (k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]) - radial * (k[5] + r2 * (2.0 * k[6] + r2 * 3.0 * k[7]))) /
      denominator;
  DistortedPoint d;
  d.m << x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
      y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  const double mixed = 2.0 * x * y * slope + 2.0 * k[2] * x + 2.0 * k[3] * y;
  d.J_plane << radial + 2.0 * x * x * slope + 2.0 * k[2] * y + 6.0 * k[3] * x, mixed, mixed,
      radial + 2.0 * y * y * slope + 6.0 * k[2] * y + 2.0 * k[3] * x;
  const Eigen::Vector3d powers = Eigen::Vector3d(r2, r2 * r2, r2 * r2 * r2) / denominator;
  d.J_coefficients.leftCols<2>() = p * powers.head<2>().transpose();
  d.J_coefficients.middleCols<2>(2) << 2.0 * x * y, r2 + 2.0 * x * x, r2 + 2.0 * y * y, 2.0 * x * y;
  d.J_coefficients.col(4) = powers[2] * p;
  d.J_coefficients.rightCols<3>() = -radial * p * powers.transpose();
  return d;
}

DistortedPoint kannala_brandt(const double* k, const Eigen::Vector2d& p) {
  const double r = std::max(p.norm(), 1e-9);
  const double theta = std::atan(r), t2 = theta * theta;
  const double radius = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const double slope = 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
  const Eigen::Vector2d direction = p / r;
  DistortedPoint d;
  d.m = radius * direction;
  const Eigen::Matrix2d outer = direction * direction.transpose();
  d.J_plane = slope / (1.0 + r * r) * outer + radius / r * (Eigen::Matrix2d::Identity() - outer);
  double power = theta;
  for (int i = 0; i < 4; ++i) d.J_coefficients.col(i) = (power *= t2) * direction;
  d.J_coefficients.rightCols<4>().setZero();
  return d;
}

/// Pixel of a point in the camera frame, and its derivatives.
struct ProjectedPoint {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> J_point;
  Eigen::Matrix<double, 2, kCameraValues> J_camera;

  ProjectedPoint(CameraModel model, const double* camera, const Eigen::Vector3d& p_c) {
    const bool in_front = p_c.z() > kNearestPoint_m;
    const double inverse_z = 1.0 / (in_front ? p_c.z() : kNearestPoint_m);
    const Eigen::Vector2d plane = inverse_z * p_c.head<2>();
    const DistortedPoint d = model == CameraModel::kKannalaBrandt ? kannala_brandt(camera + 4, plane)
                                                                  : radial_tangential(camera + 4, plane);
    const Eigen::Vector2d focal(camera[0], camera[1]);
    pixel = focal.cwiseProduct(d.m) + Eigen::Vector2d(camera[2], camera[3]);
    Eigen::Matrix<double, 2, 3> J_plane;
    J_plane << inverse_z, 0.0, in_front ? -inverse_z * plane.x() : 0.0,  //
        0.0, inverse_z, in_front ? -inverse_z * plane.y() : 0.0;
    J_point = focal.asDiagonal() * d.J_plane * J_plane;
    J_camera.leftCols<4>() << d.m.x(), 0.0, 1.0, 0.0, 0.0, d.m.y(), 0.0, 1.0;
    J_camera.rightCols<8>() = focal.asDiagonal() * d.J_coefficients;
  }
};

}  // namespace

Eigen::Vector2d projected_pixel(CameraModel model, const double* camera, const Eigen::Vector3d& p_c) {
  return ProjectedPoint(model, camera, p_c).pixel;
}

bool PixelFactor::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const PointInCamera point(x[0], x[1], x[4]);
  const ProjectedPoint projected(model_, x[2], point.p_c);
  const Eigen::Vector2d shift = measurement_.row_fraction * measurement_.velocity_px;
  Eigen::Map<Eigen::Vector2d>{residuals} = weight_ * (projected.pixel - measurement_.pixel + x[3][0] * shift);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, 2, 3> J = weight_ * projected.J_point;
  write_by_pose<2>(jacobians[0], J * point.J_pose());
  write_by_pose<2>(jacobians[1], J * point.J_extrinsics());
  if (jacobians[2] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, kCameraValues, Eigen::RowMajor>>{jacobians[2]} =
        weight_ * projected.J_camera;
  }
  if (jacobians[3] != nullptr) Eigen::Map<Eigen::Vector2d>{jacobians[3]} = weight_ * shift;
  if (jacobians[4] != nullptr)
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[4]} = J * point.J_point();
  return true;
}

Eigen::Vector3d EdgeFactor::point_in_color(const double* T_c_d, const double* depth_camera,
                                           double delay_s) const {
  const Eigen::Vector2d& u = measurement_.pixel;
  const Eigen::Vector3d ray((u.x() - depth_camera[2]) / depth_camera[0],
                            (u.y() - depth_camera[3]) / depth_camera[1], 1.0);
  return pose_of(T_c_d) * (measurement_.depth_m * ray) - delay_s * measurement_.velocity_c;
}

bool EdgeFactor::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const double* const depth_camera = x[1];
  const Eigen::Vector3d p_c = point_in_color(x[0], depth_camera, x[3][0]);
  const ProjectedPoint projected(model_, x[2], p_c);
  const Eigen::RowVector2d normal = weight_ * measurement_.normal.transpose();
  residuals[0] = normal.dot(projected.pixel - measurement_.edge);
  if (jacobians == nullptr) return true;
  const Eigen::RowVector3d J = normal * projected.J_point;
  const Pose T_c_d = pose_of(x[0]);
  const Eigen::Vector3d p_d = T_c_d.inverse() * (p_c + x[3][0] * measurement_.velocity_c);
  const Eigen::RowVector3d J_d = J * T_c_d.R();
  Eigen::Matrix<double, 1, 6> J_depth_pose;
  J_depth_pose << J, -J_d * skew(p_d);
  write_by_pose<1>(jacobians[0], J_depth_pose);
  if (jacobians[1] != nullptr) {
    const Eigen::RowVector2d by_pixel(J_d[0] * measurement_.depth_m / depth_camera[0],
                                      J_d[1] * measurement_.depth_m / depth_camera[1]);
    Eigen::Map<Eigen::RowVector4d>{jacobians[1]} = -Eigen::RowVector4d(
        by_pixel[0] * p_d.x() / p_d.z(), by_pixel[1] * p_d.y() / p_d.z(), by_pixel[0], by_pixel[1]);
  }
  if (jacobians[2] != nullptr)
    Eigen::Map<Eigen::Matrix<double, 1, kCameraValues>>{jacobians[2]} = normal * projected.J_camera;
  if (jacobians[3] != nullptr) jacobians[3][0] = -J.dot(measurement_.velocity_c);
  return true;
}

bool DepthFactor::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const PointInCamera point(x[0], x[1], x[5]);
  const Pose T_c_d = pose_of(x[2]);
  const double* const camera = x[3];
  const double scale = x[4][0];
  const Eigen::Vector3d& velocity_c = measurement_.velocity_c;
  const Eigen::Vector3d moved_c = (measurement_.row_fraction * x[6][0] + x[7][0]) * velocity_c;
  const Eigen::Vector3d p_d = T_c_d.q.conjugate() * (point.p_c + moved_c - T_c_d.p);
  const bool in_front = p_d.z() > kNearestPoint_m;
  const double inverse_z = 1.0 / (in_front ? p_d.z() : kNearestPoint_m);
  const Eigen::Vector2d plane = inverse_z * p_d.head<2>();
  const Eigen::Vector2d& g = measurement_.gradient;
  const std::optional<Eigen::Vector2d>& registered_px = measurement_.registered_px;
  const Eigen::Vector2d u =
      Eigen::Vector2d(camera[2], camera[3]) +
      (registered_px ? *registered_px : Eigen::Vector2d(camera[0] * plane.x(), camera[1] * plane.y()));
  residuals[0] =
      weight_ * (inverse_z / scale + x[4][1] - measurement_.inverse_depth - g.dot(u - measurement_.pixel));
  if (jacobians == nullptr) return true;
  Eigen::Vector2d slope(g.x() * camera[0], g.y() * camera[1]);
  if (registered_px) slope.setZero();
  const Eigen::RowVector3d J_d =
      weight_ * inverse_z *
      Eigen::RowVector3d(-slope.x(), -slope.y(), in_front ? slope.dot(plane) - inverse_z / scale : 0.0);
  const Eigen::RowVector3d J = J_d * T_c_d.R().transpose();
  write_by_pose<1>(jacobians[0], J * point.J_pose());
  write_by_pose<1>(jacobians[1], J * point.J_extrinsics());
  Eigen::Matrix<double, 1, 6> J_depth_pose;
  J_depth_pose << -J, J_d * skew(p_d);
  write_by_pose<1>(jacobians[2], J_depth_pose);
  if (jacobians[3] != nullptr) {
    Eigen::Vector2d by_focal = g.cwiseProduct(plane);
    if (registered_px) by_focal.setZero();
    Eigen::Map<Eigen::RowVector4d>{jacobians[3]} =
        -weight_ * Eigen::RowVector4d(by_focal.x(), by_focal.y(), g.x(), g.y());
  }
  if (jacobians[4] != nullptr) {
    jacobians[4][0] = -weight_ * inverse_z / (scale * scale);
    jacobians[4][1] = weight_;
  }
  if (jacobians[5] != nullptr) Eigen::Map<Eigen::RowVector3d>{jacobians[5]} = J * point.J_point();
  if (jacobians[6] != nullptr) jacobians[6][0] = measurement_.row_fraction * J.dot(velocity_c);
  if (jacobians[7] != nullptr) jacobians[7][0] = J.dot(velocity_c);
  return true;
}

LinearPriorFactor::LinearPriorFactor(Eigen::VectorXd mean, Eigen::MatrixXd A)
    : mean_(std::move(mean)), A_(std::move(A)) {
  set_num_residuals(static_cast<int>(A_.rows()));
  mutable_parameter_block_sizes()->push_back(static_cast<int>(A_.cols()));
}

bool LinearPriorFactor::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  Eigen::Map<Eigen::VectorXd>(residuals, A_.rows()) =
      A_ * (Eigen::Map<const Eigen::VectorXd>(x[0], A_.cols()) - mean_);
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], A_.rows(),
                                                                                     A_.cols()) = A_;
  return true;
}

bool PosePrior::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const Pose pose = pose_of(x[0]);
  const Eigen::Vector3d rotation = log_so3(mean_.q.conjugate() * pose.q);
  Eigen::Map<Eigen::Vector3d>{residuals} = (pose.p - mean_.p) / sigma_m_;
  Eigen::Map<Eigen::Vector3d>{residuals + 3} = rotation / sigma_rad_;
  if (jacobians == nullptr) return true;
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  J.topLeftCorner<3, 3>().diagonal().setConstant(1.0 / sigma_m_);
  J.bottomRightCorner<3, 3>() = right_jacobian_inverse(rotation) / sigma_rad_;
  write_by_pose<6>(jacobians[0], J);
  return true;
}

namespace {

/// The pose after the interval of a time; the nearest one beyond the ends.
std::vector<StampedPose>::const_iterator interval_end(const Trajectory& truth, Timestamp t) {
  const auto next = std::ranges::lower_bound(truth.poses, t, {}, &StampedPose::t);
  return std::clamp(next, truth.poses.begin() + 1, truth.poses.end() - 1);
}

}  // namespace

std::optional<Pose> truth_at(const Trajectory& truth, Timestamp t) {
  if (truth.poses.size() < 2 || t < truth.poses.front().t || truth.poses.back().t < t) return std::nullopt;
  const auto next = interval_end(truth, t), last = std::prev(next);
  const double interval_s = seconds_between(last->t, next->t);
  if (interval_s > kMaxTruthInterval_s) return std::nullopt;
  return interpolate(last->T_w_f, next->T_w_f, seconds_between(last->t, t) / interval_s);
}

bool TruthFactor::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const Pose T_w_b = pose_of(x[0]), T_w_g = pose_of(x[1]), T_f_b = pose_of(x[2]);
  const Timestamp t = after(t_, x[3][0]);
  const auto next = interval_end(truth_, t), last = std::prev(next);
  const double interval_s = seconds_between(last->t, next->t), passed_s = seconds_between(last->t, t);
  const Eigen::Vector3d rate_f = log_so3(last->T_w_f.q.conjugate() * next->T_w_f.q) / interval_s;
  const Eigen::Vector3d velocity_g = (next->T_w_f.p - last->T_w_f.p) / interval_s;
  const Pose T_g_f{last->T_w_f.q * exp_so3(passed_s * rate_f), last->T_w_f.p + passed_s * velocity_g};
  const Pose predicted = T_w_g * T_g_f * T_f_b;
  const Eigen::Vector3d rotation = log_so3(predicted.q.conjugate() * T_w_b.q);
  Eigen::Map<Eigen::Vector3d>{residuals} = (T_w_b.p - predicted.p) / sigmas_.position_m;
  Eigen::Map<Eigen::Vector3d>{residuals + 3} = rotation / sigmas_.rotation_rad;
  if (jacobians == nullptr) return true;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Eigen::Matrix<double, 6, 1> weights;
  weights << Eigen::Vector3d::Constant(1.0 / sigmas_.position_m),
      Eigen::Vector3d::Constant(1.0 / sigmas_.rotation_rad);
  const Eigen::Matrix3d by_predicted = -right_jacobian_inverse(-rotation);
  const Eigen::Matrix3d R_b_f = T_f_b.R().transpose(), R_w_f = T_w_g.R() * T_g_f.R();
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>().setIdentity();
  J.bottomRightCorner<3, 3>() = right_jacobian_inverse(rotation);
  write_by_pose<6>(jacobians[0], weights.asDiagonal() * J);
  J.topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  J.topRightCorner<3, 3>() = T_w_g.R() * skew(T_g_f * T_f_b.p);
  J.bottomRightCorner<3, 3>() = by_predicted * R_b_f * T_g_f.R().transpose();
  write_by_pose<6>(jacobians[1], weights.asDiagonal() * J);
  J.topLeftCorner<3, 3>() = -R_w_f;
  J.topRightCorner<3, 3>().setZero();
  J.bottomRightCorner<3, 3>() = by_predicted;
  write_by_pose<6>(jacobians[2], weights.asDiagonal() * J);
  if (jacobians[3] != nullptr) {
    Eigen::Matrix<double, 6, 1> by_delay;
    by_delay << -(T_w_g.R() * velocity_g + R_w_f * rate_f.cross(T_f_b.p)), by_predicted * R_b_f * rate_f;
    Eigen::Map<Eigen::Matrix<double, 6, 1>>{jacobians[3]} = weights.cwiseProduct(by_delay);
  }
  return true;
}

}  // namespace stillpoint
