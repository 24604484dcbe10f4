// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/initializer.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/decompositions.h"
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

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

/// Normal equations H x = b of the linear system A x = y of align_with_imu, x = [v_0, g, s - 1]:
/// H = A^T A, b = A^T y. If the poses are metric, s - 1 = 0 is one of the equations.
struct AlignmentEquations {
  SquareMatrix<7> H = SquareMatrix<7>::Zero();
  Vector7 b = Vector7::Zero();
  double squared = 0.0;  ///< y^T y
  int redundancy = -6;   ///< number of equations less that of unknowns, with two of gravity
};

AlignmentEquations alignment_equations(const Window& window, const Eigen::Vector3d& gyro_bias, bool metric) {
  AlignmentEquations equations;
  if (metric) {
    equations.H(6, 6) = 1.0;
    ++equations.redundancy;
  }
  const Eigen::Vector3d p_0 = window.frames[0].state.T_w_b.p;
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();  // displacement due to specific force
  Eigen::Vector3d beta = Eigen::Vector3d::Zero();   // velocity due to specific force
  double time = 0.0;
  for (int k = 1; k < static_cast<int>(window.frames.size()); ++k) {
    Preintegration imu = *window.frames[static_cast<std::size_t>(k)].from_previous;
    imu.repropagate(gyro_bias, imu.accel_bias());
    const Eigen::Quaterniond& q_w_b = window.frames[static_cast<std::size_t>(k - 1)].state.T_w_b.q;
    alpha += beta * imu.duration_s() + q_w_b * imu.delta_p(gyro_bias, imu.accel_bias());
    beta += q_w_b * imu.delta_v(gyro_bias, imu.accel_bias());
    time += imu.duration_s();
    Eigen::Matrix<double, 3, 7> A;
    A.leftCols<3>() = Eigen::Matrix3d::Identity() * time;
    A.middleCols<3>(3) = Eigen::Matrix3d::Identity() * (0.5 * time * time);
    A.col(6).setZero();
    if (!metric) A.col(6) = window.T_w_c(0).p - window.T_w_c(k).p;
    const Eigen::Vector3d y = window.frames[static_cast<std::size_t>(k)].state.T_w_b.p - p_0 - alpha;
    equations.H += A.transpose().lazyProduct(A);
    equations.b += A.transpose() * y;
    equations.squared += y.squaredNorm();
    equations.redundancy += 3;
  }
  return equations;
}

/// Two orthonormal vectors orthogonal to `direction`.
Eigen::Matrix<double, 3, 2> orthogonal_vectors(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> vectors;
  vectors << first, direction.normalized().cross(first);
  return vectors;
}

/// Least-squares solution z = [v_0, w, s - 1] with g = g' + |g'| B w, to first order in the angles w.
struct TangentSolution {
  Eigen::Matrix<double, 3, 2> B;  ///< basis of the tangent plane
  Vector6 z;
  double variance = 0.0;       ///< of the residuals
  SquareMatrix<6> covariance;  ///< of z, with that variance
};

/// @param gravity_w g'
TangentSolution solve_on_tangent_plane(const AlignmentEquations& equations,
                                       const Eigen::Vector3d& gravity_w) {
  TangentSolution solution{.B = orthogonal_vectors(gravity_w)};
  // x = x' + E z
  Eigen::Matrix<double, 7, 6> E = Eigen::Matrix<double, 7, 6>::Zero();
  E.topLeftCorner<3, 3>().setIdentity();
  E.block<3, 2>(3, 3) = gravity_w.norm() * solution.B;
  E(6, 5) = 1.0;
  Vector7 known = Vector7::Zero();
  known.segment<3>(3) = gravity_w;
  const Vector7 H_known = equations.H * known;
  const SquareMatrix<6> H = propagate<6, 7>(E.transpose(), equations.H);
  const Vector6 b = E.transpose() * (equations.b - H_known);
  solution.z = solve_symmetric(H, b);
  const double squared = equations.squared + known.dot(H_known - 2.0 * equations.b) - solution.z.dot(b);
  solution.variance = std::max(0.0, squared) / equations.redundancy;
  solution.covariance = solution.variance * solve_symmetric<6, 6>(H, SquareMatrix<6>::Identity());
  return solution;
}

/// Covariance of the direction g / |g| in its tangent plane, 3x3 of rank 2: that of the least squares, plus
/// that of an accelerometer bias, which the system cannot tell from gravity.
/// @param accel_bias_sigma [m/s^2]
Eigen::Matrix3d gravity_direction_covariance(const TangentSolution& solution, double gravity,
                                             double accel_bias_sigma) {
  const double bias_variance = std::pow(accel_bias_sigma / gravity, 2);
  return propagate<3, 2>(solution.B,
                         solution.covariance.block<2, 2>(3, 3) + bias_variance * Eigen::Matrix2d::Identity());
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
  const AlignmentEquations equations = alignment_equations(window, alignment.gyro_bias, metric);
  const Vector7 unconstrained = solve_symmetric(equations.H, equations.b);
  alignment.unconstrained_gravity = unconstrained.segment<3>(3).norm();
  if (!(std::abs(alignment.unconstrained_gravity - gravity) <= config.gravity_tolerance)) return std::nullopt;

  alignment.gravity_w = gravity * unconstrained.segment<3>(3).normalized();
  TangentSolution solution;
  for (int i = 0; i < kGravitySteps; ++i) {
    solution = solve_on_tangent_plane(equations, alignment.gravity_w);
    alignment.gravity_w =
        gravity * (alignment.gravity_w.normalized() + solution.B * solution.z.segment<2>(3)).normalized();
  }
  alignment.scale = 1.0 + solution.z[5];
  const double scale_sigma = std::sqrt(solution.covariance(5, 5));
  if (!metric && !(scale_sigma <= config.max_scale_sigma * alignment.scale)) return std::nullopt;
  const TangentSolution converged = solve_on_tangent_plane(equations, alignment.gravity_w);
  alignment.gravity_covariance = gravity_direction_covariance(converged, gravity, config.accel_bias_sigma);
  alignment.position_sigma = std::sqrt(converged.variance);
  alignment.first_velocity_w = solution.z.head<3>();
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

/// Largest standard deviation of the positions in an alignment that replaces a known gravity [m]. On 17
/// rendered recorded motions, also blurred and with a rolling shutter, it was at most 2.6 mm, with the rig of
/// `rig:seed=3` 7.7 mm, and 9.1 mm where a person left whom the first frames had followed (single runs).
constexpr double kMaxPositionSigma = 0.005;

/// Covariance of the tangent vector of gravity. A change du of its direction u is the rotation u x du.
Eigen::Matrix2d tangent_covariance(const Eigen::Vector3d& gravity_w, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix<double, 2, 3> J = gravity_basis(gravity_w).transpose() * skew(gravity_w.normalized());
  return propagate(J, covariance);
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

bool apply_alignment_to_frozen_world(const InertialAlignment& alignment, const Pose& anchor, Window& window) {
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
      tangent_covariance(window.gravity_w, propagate(R, alignment.gravity_covariance));
  const Eigen::Vector3d aligned = window.gravity_w;
  if (known) window.gravity_w = known_gravity_w;
  if (known && !contradicts(aligned, covariance, window)) return true;
  if (known && alignment.position_sigma > kMaxPositionSigma) return false;
  window.gravity_w = aligned;
  window.gravity_covariance = kReuseFactor * covariance;
  return true;
}

}  // namespace stillpoint
