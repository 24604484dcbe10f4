// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/initializer.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "core/backend/window_problem.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr int kGravitySteps = 4;
constexpr double kGaugeSigma_m = 1e-3;
constexpr double kGaugeSigma_rad = 1e-3;

/// Gyro bias that closes the gap between visual and inertial rotations, by linear least squares from the
/// present one.
Eigen::Vector3d solve_gyro_bias(const Window& window) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias = window.frames[1].from_previous->gyro_bias();
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const Preintegration& imu = *window.frames[i].from_previous;
    const Eigen::Quaterniond q_visual =
        window.frames[i - 1].state.T_w_b.q.conjugate() * window.frames[i].state.T_w_b.q;
    const Eigen::Vector3d gap = log_so3(imu.delta_q(bias).conjugate() * q_visual);
    const Eigen::Matrix3d J = imu.jacobian().block<3, 3>(ImuErrorIndex::kRotation, ImuErrorIndex::kGyroBias);
    H += J.transpose() * J;
    b += J.transpose() * gap;
  }
  return bias + H.ldlt().solve(b);
}

/// Linear system A [v0, g] = y for "where would the body be without speed and gravity" at each frame after
/// the first.
struct MotionSystem {
  Eigen::MatrixXd A;
  Eigen::VectorXd y;
};

MotionSystem motion_system(const Window& window, const Eigen::Vector3d& gyro_bias) {
  const int frames = static_cast<int>(window.frames.size());
  MotionSystem system{Eigen::MatrixXd::Zero(3 * (frames - 1), 6), Eigen::VectorXd::Zero(3 * (frames - 1))};
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

PriorBlock prior_block(const Window& window, BlockKind kind, int frame) {
  ParameterBlocks blocks = pack(window);
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
  const MotionSystem system = motion_system(window, alignment.gyro_bias);
  const Eigen::VectorXd free = system.A.colPivHouseholderQr().solve(system.y);
  alignment.free_gravity = free.tail<3>().norm();
  if (!(std::abs(alignment.free_gravity - gravity) <= config.gravity_tolerance)) return std::nullopt;

  // Hold the length: step in the plane that touches the sphere of the right radius.
  Eigen::Vector3d g = gravity * free.tail<3>().normalized();
  for (int i = 0; i < kGravitySteps; ++i) {
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(g);
    Eigen::MatrixXd A(system.A.rows(), 5);
    A << system.A.leftCols<3>(), system.A.rightCols<3>() * basis;
    const Eigen::VectorXd x = A.colPivHouseholderQr().solve(system.y - system.A.rightCols<3>() * g);
    g = gravity * (g + basis * x.tail<2>()).normalized();
    alignment.first_velocity_w = x.head<3>();
  }
  alignment.gravity_w = g;
  return alignment;
}

void make_inertial(const InertialAlignment& alignment, const Pose& anchor, Window& window) {
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
