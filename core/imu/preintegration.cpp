// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/preintegration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/base/error.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "core/imu/propagation.h"

namespace stillpoint {
namespace {

using Index = ImuErrorIndex;
using Matrix9x6 = Eigen::Matrix<double, 9, 6>;

/// The 3x3 blocks of F (see Preintegration) that are neither zero nor identity. The position rows follow from
/// the velocity rows: p' = p + dt v + dt/2 (v' - v).
struct TransitionBlocks {
  double dt;
  Eigen::Matrix3d rotation_rotation;
  Eigen::Matrix3d rotation_gyro_bias;
  Eigen::Matrix3d velocity_rotation;
  Eigen::Matrix3d velocity_gyro_bias;
  Eigen::Matrix3d velocity_accel_bias;
};

/// Linearization of a midpoint step.
TransitionBlocks linearize(const Eigen::Matrix3d& R_from, const Eigen::Vector3d& force_from,
                           const MidpointStep& step, double dt) {
  const Eigen::Matrix3d R_to = step.q_r_b.toRotationMatrix();
  const Eigen::Matrix3d force_by_rotation_to = -0.5 * dt * R_to * skew(step.force_to);
  TransitionBlocks blocks;
  blocks.dt = dt;
  blocks.rotation_rotation = R_to.transpose() * R_from;
  blocks.rotation_gyro_bias = -dt * right_jacobian(step.theta);
  blocks.velocity_rotation =
      -0.5 * dt * R_from * skew(force_from) + force_by_rotation_to * blocks.rotation_rotation;
  blocks.velocity_gyro_bias = force_by_rotation_to * blocks.rotation_gyro_bias;
  blocks.velocity_accel_bias = -0.5 * dt * (R_from + R_to);
  return blocks;
}

/// The upper 9 rows of F M, by products with the 3x3 blocks of F.
template <int Columns>
Eigen::Matrix<double, 9, Columns> apply_transition(const TransitionBlocks& blocks,
                                                   const Eigen::Matrix<double, 15, Columns>& M) {
  using Block = Eigen::Matrix<double, 3, Columns>;
  const Block rotation = M.template middleRows<3>(Index::kRotation);
  const Block velocity = M.template middleRows<3>(Index::kVelocity);
  const Block gyro_bias = M.template middleRows<3>(Index::kGyroBias);
  const Block accel_bias = M.template middleRows<3>(Index::kAccelBias);
  const Block change = blocks.velocity_rotation.lazyProduct(rotation) +
                       blocks.velocity_gyro_bias.lazyProduct(gyro_bias) +
                       blocks.velocity_accel_bias.lazyProduct(accel_bias);
  Eigen::Matrix<double, 9, Columns> result;
  result.template middleRows<3>(Index::kPosition) =
      M.template middleRows<3>(Index::kPosition) + blocks.dt * velocity + 0.5 * blocks.dt * change;
  result.template middleRows<3>(Index::kRotation) =
      blocks.rotation_rotation.lazyProduct(rotation) + blocks.rotation_gyro_bias.lazyProduct(gyro_bias);
  result.template middleRows<3>(Index::kVelocity) = velocity + change;
  return result;
}

/// F N: response to the white noise of a step. Successive steps share a sample; for the accumulated variance
/// to be sigma^2 T, the variance of the mean of two samples is taken as sigma^2 / dt, not half of it.
Matrix9x6 noise_response(const TransitionBlocks& blocks, const ImuNoise& noise) {
  const double gyro_variance = noise.gyro_noise * noise.gyro_noise / blocks.dt;
  const double accel_variance = noise.accel_noise * noise.accel_noise / blocks.dt;
  Matrix9x6 response = Matrix9x6::Zero();
  response.block<3, 3>(Index::kRotation, 0) = gyro_variance * blocks.rotation_gyro_bias;
  response.block<3, 3>(Index::kVelocity, 0) = gyro_variance * blocks.velocity_gyro_bias;
  response.block<3, 3>(Index::kVelocity, 3) = accel_variance * blocks.velocity_accel_bias;
  response.middleRows<3>(Index::kPosition) = 0.5 * blocks.dt * response.middleRows<3>(Index::kVelocity);
  return response;
}

/// P <- F (P + N) F^T + W.
void propagate_covariance(const TransitionBlocks& blocks, const ImuNoise& noise, Matrix15& covariance) {
  Eigen::Matrix<double, 9, 15> half = apply_transition<15>(blocks, covariance);
  const Matrix9x6 cross = half.rightCols<6>();
  half.rightCols<6>() += noise_response(blocks, noise);
  covariance.topLeftCorner<9, 9>() = apply_transition<9>(blocks, half.transpose());
  covariance.topRightCorner<9, 6>() = cross;
  covariance.bottomLeftCorner<6, 9>() = cross.transpose();
  covariance.diagonal().segment<3>(Index::kGyroBias).array() += noise.gyro_walk * noise.gyro_walk * blocks.dt;
  covariance.diagonal().segment<3>(Index::kAccelBias).array() +=
      noise.accel_walk * noise.accel_walk * blocks.dt;
}

}  // namespace

Preintegration::Preintegration(const ImuNoise& noise, const Eigen::Vector3d& gyro_bias,
                               const Eigen::Vector3d& accel_bias, std::vector<ImuSample> recycled)
    : noise_(noise), samples_(std::move(recycled)), gyro_bias_(gyro_bias), accel_bias_(accel_bias) {
  samples_.clear();
}

void Preintegration::integrate(const std::vector<ImuSample>& samples) {
  if (samples.empty()) return;
  if (samples_.empty()) {
    samples_.push_back(samples.front());
  } else {
    STILLPOINT_CHECK(samples.front().t == samples_.back().t);
  }
  for (std::size_t i = 1; i < samples.size(); ++i) {
    step(samples_.back(), samples[i]);
    samples_.push_back(samples[i]);
  }
  finalize();
}

void Preintegration::append(const Preintegration& later) {
  const ImuNoise larger{.gyro_noise = std::max(noise_.gyro_noise, later.noise_.gyro_noise),
                        .accel_noise = std::max(noise_.accel_noise, later.noise_.accel_noise),
                        .gyro_walk = std::max(noise_.gyro_walk, later.noise_.gyro_walk),
                        .accel_walk = std::max(noise_.accel_walk, later.noise_.accel_walk)};
  if (!(larger == noise_)) set_noise(larger);
  integrate(later.samples_);
}

void Preintegration::set_noise(const ImuNoise& noise) {
  noise_ = noise;
  repropagate(gyro_bias_, accel_bias_);
}

void Preintegration::repropagate(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias) {
  reset(gyro_bias, accel_bias);
  for (std::size_t i = 1; i < samples_.size(); ++i) step(samples_[i - 1], samples_[i]);
  finalize();
}

void Preintegration::reset(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias) {
  gyro_bias_ = gyro_bias;
  accel_bias_ = accel_bias;
  duration_s_ = 0.0;
  delta_p_.setZero();
  delta_v_.setZero();
  delta_q_.setIdentity();
  covariance_.setZero();
  jacobian_.setIdentity();
}

void Preintegration::step(const ImuSample& from, const ImuSample& to) {
  STILLPOINT_CHECK(from.t < to.t);
  const double dt = seconds_between(from.t, to.t);
  const MidpointStep step = midpoint_step(delta_q_, from, to, {.gyro = gyro_bias_, .accel = accel_bias_});
  const TransitionBlocks blocks =
      linearize(delta_q_.toRotationMatrix(), from.accel_b - accel_bias_, step, dt);

  propagate_covariance(blocks, noise_, covariance_);
  const Eigen::Matrix<double, 15, 6> bias_columns = jacobian_.rightCols<6>();
  jacobian_.topRightCorner<9, 6>() = apply_transition<6>(blocks, bias_columns);

  delta_p_ += delta_v_ * dt + 0.5 * dt * dt * step.force_r;
  delta_v_ += step.force_r * dt;
  delta_q_ = step.q_r_b;
  duration_s_ += dt;
}

/// The columns of p, theta and v have a closed form, because an error at i transforms the deltas as a whole:
/// delta_p -> Exp(theta) delta_p + p + v T. Also computes the square-root information.
void Preintegration::finalize() {
  jacobian_.block<3, 3>(Index::kPosition, Index::kRotation) = -skew(delta_p_);
  jacobian_.block<3, 3>(Index::kVelocity, Index::kRotation) = -skew(delta_v_);
  jacobian_.block<3, 3>(Index::kRotation, Index::kRotation) = delta_q_.conjugate().toRotationMatrix();
  jacobian_.block<3, 3>(Index::kPosition, Index::kVelocity) = duration_s_ * Eigen::Matrix3d::Identity();
  if (duration_s_ <= 0.0) return;
  Matrix15 regular = covariance_;
  if (samples_.size() == 2) {
    regular.diagonal().segment<3>(Index::kPosition).array() +=
        noise_.accel_noise * noise_.accel_noise * std::pow(duration_s_, 3) / 12.0;
  }
  const Eigen::LLT<Matrix15> root(regular);
  if (root.info() == Eigen::Success) {
    sqrt_information_ = root.matrixL().solve(Matrix15::Identity());
  } else {
    sqrt_information_.setZero();
  }
}

Eigen::Vector3d Preintegration::delta_p(const Eigen::Vector3d& gyro_bias,
                                        const Eigen::Vector3d& accel_bias) const {
  return delta_p_ + jacobian_.block<3, 3>(Index::kPosition, Index::kGyroBias) * (gyro_bias - gyro_bias_) +
         jacobian_.block<3, 3>(Index::kPosition, Index::kAccelBias) * (accel_bias - accel_bias_);
}

Eigen::Vector3d Preintegration::delta_v(const Eigen::Vector3d& gyro_bias,
                                        const Eigen::Vector3d& accel_bias) const {
  return delta_v_ + jacobian_.block<3, 3>(Index::kVelocity, Index::kGyroBias) * (gyro_bias - gyro_bias_) +
         jacobian_.block<3, 3>(Index::kVelocity, Index::kAccelBias) * (accel_bias - accel_bias_);
}

Eigen::Quaterniond Preintegration::delta_q(const Eigen::Vector3d& gyro_bias) const {
  const Eigen::Vector3d theta =
      jacobian_.block<3, 3>(Index::kRotation, Index::kGyroBias) * (gyro_bias - gyro_bias_);
  return (delta_q_ * exp_so3(theta)).normalized();
}

NavState Preintegration::predict(const NavState& state_i, const Eigen::Vector3d& gravity_w) const {
  const double T = duration_s_;
  const Eigen::Quaterniond& q_w_bi = state_i.T_w_b.q;
  NavState state_j = state_i;
  state_j.t = after(state_i.t, T);
  state_j.T_w_b.q = (q_w_bi * delta_q(state_i.gyro_bias)).normalized();
  state_j.T_w_b.p = state_i.T_w_b.p + state_i.v_w * T + 0.5 * T * T * gravity_w +
                    q_w_bi * delta_p(state_i.gyro_bias, state_i.accel_bias);
  state_j.v_w = state_i.v_w + T * gravity_w + q_w_bi * delta_v(state_i.gyro_bias, state_i.accel_bias);
  return state_j;
}

Eigen::Vector3d estimate_gyro_bias(std::span<const RotationPair> pairs) {
  STILLPOINT_CHECK(!pairs.empty());
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d normal_vector = Eigen::Vector3d::Zero();
  for (const RotationPair& pair : pairs) {
    const Preintegration& imu = *pair.preintegration;
    const Eigen::Matrix3d J = imu.jacobian().block<3, 3>(Index::kRotation, Index::kGyroBias);
    const Eigen::Vector3d difference = log_so3(imu.delta_q(imu.gyro_bias()).conjugate() * pair.q_bi_bj);
    normal_matrix += J.transpose() * J;
    normal_vector += J.transpose() * (difference + J * imu.gyro_bias());
  }
  return solve_symmetric(normal_matrix, normal_vector);
}

}  // namespace stillpoint
