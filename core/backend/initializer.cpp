// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/initializer.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "core/backend/window_problem.h"
#include "core/imu/gyro_bias.h"

namespace stillpoint {
namespace {

constexpr int kGravitySteps = 4;
constexpr double kGaugeSigma_m = 1e-3;
constexpr double kGaugeSigma_rad = 1e-3;

/// Gyro bias at which inertial rotations agree best with the visual ones.
Eigen::Vector3d solve_gyro_bias(const Window& window) {
  std::vector<RotationPair> pairs;
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const Eigen::Quaterniond& q_w_bi = window.frames[i - 1].state.T_w_b.q;
    pairs.push_back({.preintegration = &*window.frames[i].from_previous,
                     .q_bi_bj = q_w_bi.conjugate() * window.frames[i].state.T_w_b.q});
  }
  return estimate_gyro_bias(pairs);
}

/// Linear system A [v0, g, s - 1] = y for "where would the body be without speed and gravity" at each frame
/// after the first. The scale s stretches the paths of the camera, not its lever arm to the body; without
/// that last column it is 1.
struct MotionSystem {
  Eigen::MatrixXd A;
  Eigen::VectorXd y;
};

MotionSystem motion_system(const Window& window, const Eigen::Vector3d& gyro_bias, bool metric) {
  const int frames = static_cast<int>(window.frames.size());
  MotionSystem system{Eigen::MatrixXd::Zero(3 * (frames - 1), metric ? 6 : 7),
                      Eigen::VectorXd::Zero(3 * (frames - 1))};
  const Eigen::Vector3d p_0 = window.frames[0].state.T_w_b.p;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();    // displacement by specific force alone
  Eigen::Vector3d speeded = Eigen::Vector3d::Zero();  // speed by specific force alone
  double time = 0.0;
  for (int k = 1; k < frames; ++k) {
    Preintegration imu = *window.frames[static_cast<std::size_t>(k)].from_previous;
    imu.repropagate(gyro_bias, imu.accel_bias());
    const Eigen::Quaterniond& q_w_b = window.frames[static_cast<std::size_t>(k - 1)].state.T_w_b.q;
    moved += speeded * imu.duration_s() + q_w_b * imu.delta_p(gyro_bias, imu.accel_bias());
    speeded += q_w_b * imu.delta_v(gyro_bias, imu.accel_bias());
    time += imu.duration_s();
    system.A.block<3, 3>(3 * (k - 1), 0) = Eigen::Matrix3d::Identity() * time;
    system.A.block<3, 3>(3 * (k - 1), 3) = Eigen::Matrix3d::Identity() * (0.5 * time * time);
    if (!metric) system.A.block<3, 1>(3 * (k - 1), 6) = window.T_w_c(0).p - window.T_w_c(k).p;
    system.y.segment<3>(3 * (k - 1)) = window.frames[static_cast<std::size_t>(k)].state.T_w_b.p - p_0 - moved;
  }
  return system;
}

/// Two unit vectors square to `direction` and to each other.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> basis;
  basis << first, direction.normalized().cross(first);
  return basis;
}

/// The motion system's solution under gravity of the right length.
struct HeldGravity {
  Eigen::Vector3d gravity_w;
  Eigen::VectorXd motion;  ///< v0, two steps of gravity that have come to rest, and s - 1 if it is asked
  bool scale_is_known = true;
};

/// Steps in the plane that touches the sphere of the right radius.
/// @param gravity_w start, of the right length
HeldGravity hold_gravity(const MotionSystem& system, const Eigen::Vector3d& gravity_w,
                         double max_scale_sigma) {
  const Eigen::MatrixXd A_gravity = system.A.middleCols<3>(3);
  const Eigen::Index scale_columns = system.A.cols() - 6;
  HeldGravity held{.gravity_w = gravity_w};
  Eigen::MatrixXd A(system.A.rows(), 5 + scale_columns);
  Eigen::VectorXd misfit;
  for (int i = 0; i < kGravitySteps; ++i) {
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(held.gravity_w);
    A << system.A.leftCols<3>(), A_gravity * basis, system.A.rightCols(scale_columns);
    const Eigen::VectorXd y = system.y - A_gravity * held.gravity_w;
    held.motion = A.colPivHouseholderQr().solve(y);
    misfit = y - A * held.motion;
    held.gravity_w = gravity_w.norm() * (held.gravity_w + basis * held.motion.segment<2>(3)).normalized();
  }
  if (scale_columns == 0) return held;
  const double variance = misfit.squaredNorm() / static_cast<double>(A.rows() - A.cols());
  const Eigen::MatrixXd covariance = variance * (A.transpose() * A).inverse();
  const double scale = 1.0 + held.motion[5];
  held.scale_is_known = std::sqrt(covariance(5, 5)) <= max_scale_sigma * scale;
  return held;
}

/// Makes the paths of the camera `scale` times as long, and the landmarks as much farther.
void stretch(double scale, Window& window) {
  const Eigen::Vector3d p_0 = window.T_w_c(0).p;
  for (int i = 0; i <= window.newest(); ++i) {
    window.frames[static_cast<std::size_t>(i)].state.T_w_b.p += (scale - 1.0) * (window.T_w_c(i).p - p_0);
  }
  for (Landmark& landmark : window.landmarks) landmark.inverse_depth /= scale;
}

PriorBlock prior_block(const Window& window, BlockKind kind, int frame) {
  ParameterBlocks blocks(window);
  const double* now = block_address(blocks, {kind, frame});
  return {kind, frame, Eigen::Map<const Eigen::VectorXd>(now, global_size(kind))};
}

Eigen::Matrix<double, 6, 6> pose_root_information(double sigma_m, double sigma_rad) {
  Eigen::Matrix<double, 6, 1> diagonal;
  diagonal << Eigen::Vector3d::Constant(1.0 / sigma_m), Eigen::Vector3d::Constant(1.0 / sigma_rad);
  return diagonal.asDiagonal();
}

}  // namespace

std::optional<InertialAlignment> align_with_imu(const Window& window, double gravity,
                                                const InitializerConfig& config) {
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    if (!window.frames[i].from_previous) return std::nullopt;
  }
  InertialAlignment alignment;
  alignment.gyro_bias = solve_gyro_bias(window);
  const bool metric = config.kind != InitializerKind::kMonocular;
  const MotionSystem system = motion_system(window, alignment.gyro_bias, metric);
  const Eigen::VectorXd free = system.A.colPivHouseholderQr().solve(system.y);
  alignment.free_gravity = free.segment<3>(3).norm();
  if (!(std::abs(alignment.free_gravity - gravity) <= config.gravity_tolerance)) return std::nullopt;

  const HeldGravity held =
      hold_gravity(system, gravity * free.segment<3>(3).normalized(), config.max_scale_sigma);
  if (!held.scale_is_known) return std::nullopt;
  alignment.gravity_w = held.gravity_w;
  alignment.first_velocity_w = held.motion.head<3>();
  if (!metric) alignment.scale = 1.0 + held.motion[5];
  return alignment;
}

void make_inertial(const InertialAlignment& alignment, const Pose& anchor, Window& window) {
  stretch(alignment.scale, window);
  const Eigen::Quaterniond q_level =
      Eigen::Quaterniond::FromTwoVectors(alignment.gravity_w, -Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d R_0 = (q_level * window.frames[0].state.T_w_b.q).toRotationMatrix();
  const Eigen::Matrix3d R_anchor = anchor.R();
  // Heading between the two, from the body axis that lies flattest in both.
  const Eigen::Matrix3d R_turn = R_anchor * R_0.transpose();
  const double yaw = std::atan2(R_turn(1, 0) - R_turn(0, 1), R_turn(0, 0) + R_turn(1, 1));
  const Eigen::Quaterniond q_new_old = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * q_level;
  const Pose T_new_old{q_new_old, anchor.p - q_new_old * window.frames[0].state.T_w_b.p};

  window.gravity_w = Eigen::Vector3d(0.0, 0.0, -alignment.gravity_w.norm());
  window.inertial = true;
  Eigen::Vector3d velocity = q_new_old * alignment.first_velocity_w;
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    NavState& state = window.frames[i].state;
    state.T_w_b = T_new_old * state.T_w_b;
    state.gyro_bias = alignment.gyro_bias;
    if (i > 0) {
      Preintegration& imu = *window.frames[i].from_previous;
      imu.repropagate(alignment.gyro_bias, state.accel_bias);
      velocity += window.gravity_w * imu.duration_s() +
                  window.frames[i - 1].state.T_w_b.q * imu.delta_v(alignment.gyro_bias, state.accel_bias);
    }
    state.v_w = velocity;
  }
}

LinearPrior first_prior(const Window& window, const InitializerConfig& config) {
  LinearPrior prior;
  prior.blocks.push_back(prior_block(window, BlockKind::kPose, 0));
  if (!window.inertial) {
    prior.residual = Eigen::VectorXd::Zero(6);
    prior.jacobian = pose_root_information(kGaugeSigma_m, kGaugeSigma_rad);
    return prior;
  }
  prior.blocks.push_back(prior_block(window, BlockKind::kSpeedBias, 0));
  // Rows: position, heading, gyro bias, accel bias. The body turned by theta heads off by e_z . R theta.
  prior.residual = Eigen::VectorXd::Zero(10);
  prior.jacobian = Eigen::MatrixXd::Zero(10, 15);
  prior.jacobian.block<3, 3>(0, 0).diagonal().setConstant(1.0 / kGaugeSigma_m);
  prior.jacobian.block<1, 3>(3, 3) = window.frames.front().state.T_w_b.R().row(2) / kGaugeSigma_rad;
  prior.jacobian.block<3, 3>(4, 9).diagonal().setConstant(1.0 / config.gyro_bias_sigma);
  prior.jacobian.block<3, 3>(7, 12).diagonal().setConstant(1.0 / config.accel_bias_sigma);
  return prior;
}

LinearPrior calibration_prior(const Window& window, const BackendConfig& config) {
  LinearPrior prior;
  prior.blocks.push_back(prior_block(window, BlockKind::kExtrinsics, -1));
  prior.blocks.push_back(prior_block(window, BlockKind::kTimeOffset, -1));
  prior.residual = Eigen::VectorXd::Zero(7);
  prior.jacobian = Eigen::MatrixXd::Zero(7, 7);
  prior.jacobian.topLeftCorner<6, 6>() =
      pose_root_information(config.extrinsics_sigma_m, config.extrinsics_sigma_rad);
  prior.jacobian(6, 6) = 1.0 / config.time_offset_sigma_s;
  return prior;
}

}  // namespace stillpoint
