// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/initial_prior.h"

#include <utility>

#include "core/backend/solvers/window_problem.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kGaugeSigma_m = 1e-3;
constexpr double kGaugeSigma_rad = 1e-3;

/// [m] and [rad]: exact up to rounding errors, so that covariances are relative to the first pose.
constexpr double kExactSigma = 1e-6;

/// What calibrations of consumer cameras are off by: 2 % of the focal length, 0.05 of k1, 5 px of the center.
const Eigen::Vector4d kLensSigma{0.02, 0.05, 0.01, 0.01};

/// Jump of the oldest pose in one solve above which the gauge is restored.
constexpr double kJump_m = 0.1;
constexpr double kJump_rad = 0.02;

PriorBlock prior_block(const Window& window, BlockKind kind, int frame) {
  const ParameterBlocks blocks(window);
  const double* values = blocks.at({kind, frame});
  return {kind, frame, Eigen::Map<const Eigen::VectorXd>(values, global_size(kind))};
}

Eigen::Matrix<double, 6, 6> pose_root_information(double sigma_m, double sigma_rad) {
  Eigen::Matrix<double, 6, 1> diagonal;
  diagonal << Eigen::Vector3d::Constant(1.0 / sigma_m), Eigen::Vector3d::Constant(1.0 / sigma_rad);
  return diagonal.asDiagonal();
}

/// Whether the pose of the first camera fixes the gauge, see initial_prior.
bool is_fixed_by_camera(const Window& window, const BackendConfig& config) {
  return config.prior == PriorModel::kConsistent && estimates_extrinsics(window, config);
}

/// Of the camera pose in the body by the body pose and, in the last six columns, the extrinsics (p, theta):
///
///   R_w_b^T dp_w_c = R_w_b^T dp_w_b - [p_b_c]x dtheta_w_b + dp_b_c,    dtheta_w_c = R_b_c^T dtheta_w_b +
///   dtheta_b_c.
Eigen::Matrix<double, 6, 12> camera_pose_jacobian(const Pose& T_w_b, const Pose& T_b_c) {
  Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();
  J.block<3, 3>(0, 0) = T_w_b.R().transpose();
  J.block<3, 3>(0, 3) = -skew(T_b_c.p);
  J.block<3, 3>(3, 3) = T_b_c.R().transpose();
  J.rightCols<6>().setIdentity();
  return J;
}

/// Rows: position, heading, gyro bias, accel bias. d heading / d theta = e_z^T R.
LinearPrior prior_of_level_world(LinearPrior prior, const Window& window, const BackendConfig& config) {
  prior.residual = Eigen::VectorXd::Zero(10);
  prior.jacobian = Eigen::MatrixXd::Zero(10, 15);
  prior.jacobian.block<3, 3>(0, 0).diagonal().setConstant(1.0 / kGaugeSigma_m);
  prior.jacobian.block<1, 3>(3, 3) = window.frames.front().state.T_w_b.R().row(2) / kGaugeSigma_rad;
  prior.jacobian.block<3, 3>(4, 9).diagonal().setConstant(1.0 / config.initializer.gyro_bias_sigma);
  prior.jacobian.block<3, 3>(7, 12).diagonal().setConstant(1.0 / config.initializer.accel_bias_sigma);
  return prior;
}

/// Rows: pose, gyro bias, accel bias, gravity (the inverse Cholesky factor of its covariance).
LinearPrior prior_with_gravity(LinearPrior prior, const Window& window, const BackendConfig& config) {
  prior.blocks.push_back(prior_block(window, BlockKind::kGravity, -1));
  prior.residual = Eigen::VectorXd::Zero(14);
  prior.jacobian = Eigen::MatrixXd::Zero(14, 17);
  prior.jacobian.topLeftCorner<6, 6>() = config.prior == PriorModel::kConsistent
                                             ? pose_root_information(kExactSigma, kExactSigma)
                                             : pose_root_information(kGaugeSigma_m, kGaugeSigma_rad);
  prior.jacobian.block<3, 3>(6, 9).diagonal().setConstant(1.0 / config.initializer.gyro_bias_sigma);
  prior.jacobian.block<3, 3>(9, 12).diagonal().setConstant(1.0 / config.initializer.accel_bias_sigma);
  prior.jacobian.block<2, 2>(12, 15) = inverse_root(*window.gravity_covariance);
  return prior;
}

/// Replaces the rows of the pose by those of the camera pose.
LinearPrior prior_fixed_by_camera(LinearPrior prior, const Window& window) {
  const Eigen::Matrix<double, 6, 12> J =
      camera_pose_jacobian(window.frames.front().state.T_w_b, window.T_b_c) / kExactSigma;
  const Eigen::MatrixXd others = prior.jacobian;
  prior.blocks.push_back(prior_block(window, BlockKind::kExtrinsics, -1));
  prior.jacobian = Eigen::MatrixXd::Zero(others.rows(), others.cols() + 6);
  prior.jacobian.leftCols(others.cols()) = others;
  prior.jacobian.topLeftCorner<6, 6>() = J.leftCols<6>();
  prior.jacobian.topRightCorner<6, 6>() = J.rightCols<6>();
  return prior;
}

}  // namespace

LinearPrior initial_prior(const Window& window, const BackendConfig& config) {
  LinearPrior prior;
  prior.blocks.push_back(prior_block(window, BlockKind::kPose, 0));
  if (!window.inertial) {
    prior.residual = Eigen::VectorXd::Zero(6);
    prior.jacobian = pose_root_information(kGaugeSigma_m, kGaugeSigma_rad);
    return prior;
  }
  prior.blocks.push_back(prior_block(window, BlockKind::kSpeedBias, 0));
  if (!window.gravity_covariance) return prior_of_level_world(std::move(prior), window, config);
  prior = prior_with_gravity(std::move(prior), window, config);
  return is_fixed_by_camera(window, config) ? prior_fixed_by_camera(std::move(prior), window) : prior;
}

LinearPrior calibration_prior(const Window& window, const BackendConfig& config) {
  LinearPrior prior;
  prior.blocks.push_back(prior_block(window, BlockKind::kExtrinsics, -1));
  prior.blocks.push_back(prior_block(window, BlockKind::kTimeOffset, -1));
  if (config.depth.estimate_scale) prior.blocks.push_back(prior_block(window, BlockKind::kDepthScale, -1));
  if (config.estimate_lens) prior.blocks.push_back(prior_block(window, BlockKind::kLens, -1));
  const Eigen::Index size = 7 + (config.depth.estimate_scale ? 1 : 0) + (config.estimate_lens ? 4 : 0);
  prior.residual = Eigen::VectorXd::Zero(size);
  prior.jacobian = Eigen::MatrixXd::Zero(size, size);
  prior.jacobian.topLeftCorner<6, 6>() =
      pose_root_information(config.extrinsics_sigma_m, config.extrinsics_sigma_rad);
  prior.jacobian(6, 6) = 1.0 / config.time_offset_sigma_s;
  if (config.depth.estimate_scale) prior.jacobian(7, 7) = 1.0 / config.depth.scale_sigma;
  if (config.estimate_lens) prior.jacobian.diagonal().tail<4>() = kLensSigma.cwiseInverse();
  return prior;
}

LinearPrior aligned_calibration_prior(const Window& window, const BackendConfig& config,
                                      const Eigen::Matrix4d& rotation_and_offset) {
  LinearPrior prior = calibration_prior(window, config);
  // Rotation and time offset are adjacent, in columns 3 to 6.
  prior.jacobian.block<4, 4>(3, 3) = inverse_root(rotation_and_offset);
  return prior;
}

bool restore_gauge(const Pose& oldest_T_w_b, const BackendConfig& config, Window& window) {
  const Pose& current = window.frames.front().state.T_w_b;
  const bool translated = (current.p - oldest_T_w_b.p).norm() > kJump_m;
  const bool rotated = current.q.angularDistance(oldest_T_w_b.q) > kJump_rad;
  if (!translated && !rotated) return false;
  const Pose correction = oldest_T_w_b * current.inverse();
  for (WindowFrame& frame : window.frames) frame.state.T_w_b = correction * frame.state.T_w_b;
  window.prior = initial_prior(window, config);
  return true;
}

}  // namespace stillpoint
