// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/initializer.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <Eigen/QR>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/so3.h"
#include "core/imu/preintegration.h"

namespace stillpoint {
namespace {

constexpr int kGravitySteps = 4;

/// Gyro bias that aligns the preintegrated rotations with the visual ones.
Eigen::Vector3d solve_gyro_bias(const Window& window) {
  std::vector<RotationPair> pairs;
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const Eigen::Quaterniond& q_w_bi = window.frames[i - 1].state.T_w_b.q;
    pairs.push_back({.preintegration = &*window.frames[i].from_previous,
                     .q_bi_bj = q_w_bi.conjugate() * window.frames[i].state.T_w_b.q});
  }
  return estimate_gyro_bias(pairs);
}

/// Linear system A [v_0, g, s - 1] = y of align_with_imu, three rows per frame k >= 1; without the last
/// column s = 1.
struct AlignmentSystem {
  Eigen::MatrixXd A;
  Eigen::VectorXd y;
};

AlignmentSystem alignment_system(const Window& window, const Eigen::Vector3d& gyro_bias, bool metric) {
  const int frames = static_cast<int>(window.frames.size());
  const Eigen::Index rows = 3 * Eigen::Index{frames - 1};
  AlignmentSystem system{Eigen::MatrixXd::Zero(rows, metric ? 6 : 7), Eigen::VectorXd::Zero(rows)};
  const Eigen::Vector3d p_0 = window.frames[0].state.T_w_b.p;
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();  // displacement due to specific force
  Eigen::Vector3d beta = Eigen::Vector3d::Zero();   // velocity due to specific force
  double time = 0.0;
  for (int k = 1; k < frames; ++k) {
    Preintegration imu = *window.frames[static_cast<std::size_t>(k)].from_previous;
    imu.repropagate(gyro_bias, imu.accel_bias());
    const Eigen::Quaterniond& q_w_b = window.frames[static_cast<std::size_t>(k - 1)].state.T_w_b.q;
    alpha += beta * imu.duration_s() + q_w_b * imu.delta_p(gyro_bias, imu.accel_bias());
    beta += q_w_b * imu.delta_v(gyro_bias, imu.accel_bias());
    time += imu.duration_s();
    const Eigen::Index row = 3 * Eigen::Index{k - 1};
    system.A.block<3, 3>(row, 0) = Eigen::Matrix3d::Identity() * time;
    system.A.block<3, 3>(row, 3) = Eigen::Matrix3d::Identity() * (0.5 * time * time);
    if (!metric) system.A.block<3, 1>(row, 6) = window.T_w_c(0).p - window.T_w_c(k).p;
    system.y.segment<3>(row) = window.frames[static_cast<std::size_t>(k)].state.T_w_b.p - p_0 - alpha;
  }
  return system;
}

/// Solution of the alignment system with the norm of gravity constrained.
struct RefinedGravity {
  Eigen::Vector3d gravity_w;
  Eigen::VectorXd solution;  ///< v_0, last increment w, and s - 1 if estimated
  bool scale_is_certain = true;
};

/// Gravity refinement on the tangent plane (see align_with_imu).
/// @param gravity_w initial guess, of the configured norm
RefinedGravity refine_gravity(const AlignmentSystem& system, const Eigen::Vector3d& gravity_w,
                              double max_scale_sigma) {
  const Eigen::MatrixXd A_gravity = system.A.middleCols<3>(3);
  const Eigen::Index scale_columns = system.A.cols() - 6;
  RefinedGravity refined{.gravity_w = gravity_w};
  Eigen::MatrixXd A(system.A.rows(), 5 + scale_columns);
  Eigen::VectorXd residual;
  for (int i = 0; i < kGravitySteps; ++i) {
    const Eigen::Matrix<double, 3, 2> basis = orthogonal_vectors(refined.gravity_w);
    A << system.A.leftCols<3>(), A_gravity * basis, system.A.rightCols(scale_columns);
    const Eigen::VectorXd y = system.y - A_gravity * refined.gravity_w;
    refined.solution = A.colPivHouseholderQr().solve(y);
    residual = y - A * refined.solution;
    refined.gravity_w =
        gravity_w.norm() * (refined.gravity_w + basis * refined.solution.segment<2>(3)).normalized();
  }
  if (scale_columns == 0) return refined;
  const double variance = residual.squaredNorm() / static_cast<double>(A.rows() - A.cols());
  const Eigen::MatrixXd covariance = variance * least_squares_covariance(A);
  const double scale = 1.0 + refined.solution[5];
  refined.scale_is_certain = std::sqrt(covariance(5, 5)) <= max_scale_sigma * scale;
  return refined;
}

/// Scales camera positions (about camera 0) and landmark depths by `scale`.
void rescale(double scale, Window& window) {
  const Eigen::Vector3d p_0 = window.T_w_c(0).p;
  for (int i = 0; i <= window.newest(); ++i) {
    window.frames[static_cast<std::size_t>(i)].state.T_w_b.p += (scale - 1.0) * (window.T_w_c(i).p - p_0);
  }
  for (Landmark& landmark : window.landmarks) landmark.inverse_depth /= scale;
}

}  // namespace

std::optional<InertialAlignment> align_with_imu(const Window& window, double gravity,
                                                const InitializerConfig& config) {
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    if (!window.frames[i].from_previous || !window.frames[i].imu_is_reliable) return std::nullopt;
  }
  InertialAlignment alignment;
  alignment.gyro_bias = solve_gyro_bias(window);
  const bool metric = config.kind != InitializerKind::kMonocular;
  const AlignmentSystem system = alignment_system(window, alignment.gyro_bias, metric);
  const Eigen::VectorXd unconstrained = system.A.colPivHouseholderQr().solve(system.y);
  alignment.unconstrained_gravity = unconstrained.segment<3>(3).norm();
  if (!(std::abs(alignment.unconstrained_gravity - gravity) <= config.gravity_tolerance)) return std::nullopt;

  const RefinedGravity refined =
      refine_gravity(system, gravity * unconstrained.segment<3>(3).normalized(), config.max_scale_sigma);
  if (!refined.scale_is_certain) return std::nullopt;
  alignment.gravity_w = refined.gravity_w;
  alignment.gravity_covariance =
      gravity_direction_covariance({system.A, system.y}, refined.gravity_w, config.accel_bias_sigma);
  alignment.first_velocity_w = refined.solution.head<3>();
  if (!metric) alignment.scale = 1.0 + refined.solution[5];
  return alignment;
}

void apply_alignment(const InertialAlignment& alignment, const Pose& anchor, Window& window) {
  rescale(alignment.scale, window);
  const Eigen::Quaterniond q_level = level_rotation(alignment.gravity_w);
  const Eigen::Matrix3d R_0 = (q_level * window.frames[0].state.T_w_b.q).toRotationMatrix();
  const Eigen::Matrix3d R_anchor = anchor.R();
  // Heading difference: the rotation about z closest to R_turn.
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

namespace {

/// Ratio of the covariance of gravity in the initial prior to that of the alignment, which used the same
/// samples.
constexpr double kReuseFactor = 100.0;

/// 0.999 quantile of the chi-square distribution with two degrees of freedom.
constexpr double kGravityGate = 13.8;

/// Covariance of the tangent vector of gravity. A change du of its direction u is the rotation u x du.
Eigen::Matrix2d tangent_covariance(const Eigen::Vector3d& gravity_w, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix<double, 2, 3> J = gravity_basis(gravity_w).transpose() * skew(gravity_w.normalized());
  return J * covariance * J.transpose();
}

/// Whether a measured gravity contradicts the gravity of the window.
bool contradicts(const Eigen::Vector3d& measured, const Eigen::Matrix2d& covariance, const Window& window) {
  const Eigen::Vector2d difference = gravity_difference(measured, window.gravity_w);
  const Eigen::Matrix2d sum = covariance + *window.gravity_covariance;
  return !(difference.dot(sum.inverse() * difference) <= kGravityGate);
}

/// Rotates all states about the position of frame 0 such that it has the attitude of `anchor`.
/// @return the rotation
Eigen::Quaterniond restore_attitude(const Pose& anchor, Window& window) {
  const Pose first = window.frames[0].state.T_w_b;
  Eigen::Quaterniond q_new_old = (anchor.q * first.q.conjugate()).normalized();
  const Pose T_new_old{q_new_old, first.p - q_new_old * first.p};
  for (WindowFrame& frame : window.frames) {
    frame.state.T_w_b = T_new_old * frame.state.T_w_b;
    frame.state.v_w = q_new_old * frame.state.v_w;
  }
  return q_new_old;
}

}  // namespace

Eigen::Matrix<double, 3, 2> orthogonal_vectors(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> vectors;
  vectors << first, direction.normalized().cross(first);
  return vectors;
}

// Inlined, it would be rounded differently in the alignment.
[[gnu::noinline]] Eigen::MatrixXd least_squares_covariance(const Eigen::MatrixXd& A) {
  return (A.transpose() * A).inverse();
}

Eigen::Matrix3d gravity_direction_covariance(const AlignmentEquations& equations,
                                             const Eigen::Vector3d& gravity_w, double accel_bias_sigma) {
  const double norm = gravity_w.norm();
  const Eigen::Matrix<double, 3, 2> basis = orthogonal_vectors(gravity_w);
  const Eigen::Index scale_columns = equations.A.cols() - 6;
  Eigen::MatrixXd A(equations.A.rows(), 5 + scale_columns);
  A << equations.A.leftCols<3>(), norm * equations.A.middleCols<3>(3) * basis,
      equations.A.rightCols(scale_columns);
  const Eigen::VectorXd y = equations.y - equations.A.middleCols<3>(3) * gravity_w;
  const Eigen::MatrixXd covariance = least_squares_covariance(A);
  const double variance =
      (y - A * (covariance * (A.transpose() * y))).squaredNorm() / static_cast<double>(A.rows() - A.cols());
  const double bias_variance = accel_bias_sigma * accel_bias_sigma / (norm * norm);
  return basis * (variance * covariance.block<2, 2>(3, 3) + bias_variance * Eigen::Matrix2d::Identity()) *
         basis.transpose();
}

void apply_alignment_to_frozen_world(const InertialAlignment& alignment, const Pose& anchor, Window& window) {
  const Eigen::Vector3d known_gravity_w = window.gravity_w;
  const bool known = window.gravity_covariance.has_value();
  // Gravity and its covariance move with the poses.
  const Eigen::Quaterniond q_w_v = window.frames[0].state.T_w_b.q;
  apply_alignment(alignment, anchor, window);
  Eigen::Quaterniond q_new_old = window.frames[0].state.T_w_b.q * q_w_v.conjugate();
  if (known) {
    const Eigen::Quaterniond q_restored = restore_attitude(anchor, window);
    q_new_old = q_restored * q_new_old;
    window.gravity_w = q_restored * window.gravity_w;
  }
  const Eigen::Matrix3d R = q_new_old.toRotationMatrix();
  const Eigen::Matrix2d covariance =
      tangent_covariance(window.gravity_w, R * alignment.gravity_covariance * R.transpose());
  const Eigen::Vector3d aligned = window.gravity_w;
  if (known) window.gravity_w = known_gravity_w;
  if (known && !contradicts(aligned, covariance, window)) return;
  window.gravity_w = aligned;
  window.gravity_covariance = kReuseFactor * covariance;
}

}  // namespace stillpoint
