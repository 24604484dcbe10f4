// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/bias_check.h"

#include <utility>

namespace stillpoint {
namespace {

constexpr double kBiasInterval_s = 0.24;
constexpr double kMaxBiasPause_s = 0.2;  // between measurements of the same step
constexpr double kMinStepCosine = 0.9;

/// Error of the bias of one sensor: e > base + factor * sigma.
struct BiasLimit {
  double base;
  double sigmas;
};
constexpr BiasLimit kGyroStep{.base = 0.006, .sigmas = 8.0};  // [rad/s]
constexpr BiasLimit kAccelStep{.base = 0.05, .sigmas = 4.0};  // [m/s^2]
constexpr BiasLimit kGyroAgreement{.base = 0.008, .sigmas = 1.0};
constexpr BiasLimit kAccelAgreement{.base = 0.15, .sigmas = 1.0};

struct BiasError {
  Eigen::Vector3d e;
  double sigma;

  [[nodiscard]] bool exceeds(const BiasLimit& limit) const {
    return e.norm() > limit.base + limit.sigmas * sigma;
  }
  [[nodiscard]] bool continues(const BiasError& earlier, const BiasLimit& limit) const {
    return exceeds(limit) && earlier.exceeds(limit) &&
           e.dot(earlier.e) >= kMinStepCosine * e.norm() * earlier.e.norm();
  }
};

BiasError gyro_bias_error(const MeasuredBiases& measured, const NavState& state) {
  return {measured.gyro - state.gyro_bias, measured.gyro_sigma};
}

BiasError accel_bias_error(const MeasuredBiases& measured, const NavState& state) {
  return {measured.accel - state.accel_bias, measured.accel_sigma};
}

}  // namespace

BiasCheck::Result BiasCheck::update(const Window& window, ImuBuffer& imu) {
  if (!views_.add(window)) return Result::kUnknown;
  const std::optional<MeasuredBiases> before = std::exchange(measured_, measure(window, imu));
  if (!measured_) return Result::kUnknown;
  const NavState& state = window.frames.back().state;
  const BiasError gyro = gyro_bias_error(*measured_, state), accel = accel_bias_error(*measured_, state);
  if (!gyro.exceeds(kGyroAgreement) && !accel.exceeds(kAccelAgreement)) return Result::kAgrees;
  if (!gyro.exceeds(kGyroStep) && !accel.exceeds(kAccelStep)) return Result::kUnknown;
  if (!before || seconds_between(before->t, measured_->t) > kMaxBiasPause_s) return Result::kDiffers;
  const bool step = gyro.continues(gyro_bias_error(*before, state), kGyroStep) ||
                    accel.continues(accel_bias_error(*before, state), kAccelStep);
  return step ? Result::kStep : Result::kDiffers;
}

std::optional<MeasuredBiases> BiasCheck::measure(const Window& window, ImuBuffer& imu) {
  const std::size_t last = views_.size() - 1;
  const std::optional<std::size_t> middle = views_.before(views_[last].t, kBiasInterval_s);
  if (!middle) return std::nullopt;
  const std::optional<std::size_t> first = views_.before(views_[*middle].t, kBiasInterval_s);
  if (!first) return std::nullopt;
  const VisualPose A{.t = views_[*first].t, .T_w_b = views_[*first].T_w_b};
  const std::optional<VisualPose> B = views_.pose_after(A, *first, *middle, window.T_b_c);
  if (!B) return std::nullopt;
  const std::optional<VisualPose> C = views_.pose_after(*B, *middle, last, window.T_b_c);
  if (!C) return std::nullopt;
  const NavState& state = window.frames.back().state;
  const std::optional<InertialError> error =
      inertial_error({.A = A, .B = *B, .C = *C}, state, window.gravity_w, imu);
  if (!error) return std::nullopt;
  return MeasuredBiases{.t = C->t,
                        .gyro = state.gyro_bias + error->gyro_b,
                        .accel = state.accel_bias + B->T_w_b.q.conjugate() * error->accel_w,
                        .gyro_sigma = error->gyro_sigma,
                        .accel_sigma = error->accel_sigma};
}

}  // namespace stillpoint
