// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/bias_check.h"

#include <algorithm>

namespace stillpoint {
namespace {

constexpr double kBiasInterval_s = 0.24;
constexpr double kMaxBiasPause_s = 0.2;  // between measurements of the same step
constexpr double kMinStepCosine = 0.9;

constexpr int kCertainFeatures = 40;
constexpr double kCertainRatio = 0.33;  // of the tracked features

/// Error of the bias of one sensor: e > base + factor * sigma.
struct BiasLimit {
  double base;
  double sigmas;
};

constexpr BiasLimit kGyroAgreement{.base = 0.003, .sigmas = 1.0};  // [rad/s]
constexpr BiasLimit kAccelAgreement{.base = 0.15, .sigmas = 1.0};  // [m/s^2]

/// Errors in succession from which a step is recognized, whether vision must have been certain, and whether
/// the data must have changed by one of them.
struct StepRule {
  BiasLimit limit;
  std::size_t errors;
  bool certain;
  bool explained;
};
constexpr StepRule kGyroRules[] = {
    {.limit = {.base = 0.05, .sigmas = 16.0}, .errors = 1, .certain = true, .explained = true},
    {.limit = {.base = 0.006, .sigmas = 8.0}, .errors = 2, .certain = true, .explained = false},
    {.limit = {.base = 0.0015, .sigmas = 2.0}, .errors = 6, .certain = true, .explained = false}};
constexpr StepRule kAccelRules[] = {
    {.limit = {.base = 0.2, .sigmas = 4.0}, .errors = 1, .certain = true, .explained = true},
    {.limit = {.base = 0.2, .sigmas = 3.0}, .errors = 2, .certain = false, .explained = true},
    {.limit = {.base = 0.05, .sigmas = 1.5}, .errors = 3, .certain = false, .explained = false}};
constexpr BiasLimit kGyroDifference{.base = 0.006, .sigmas = 8.0};
constexpr BiasLimit kAccelDifference{.base = 0.05, .sigmas = 4.0};
constexpr std::size_t kMaxErrors = 6;

struct BiasError {
  Eigen::Vector3d e;
  double sigma;
  bool explained;

  [[nodiscard]] bool exceeds(const BiasLimit& limit) const {
    return e.norm() > limit.base + limit.sigmas * sigma;
  }
  [[nodiscard]] bool has_direction_of(const BiasError& other) const {
    return e.dot(other.e) >= kMinStepCosine * e.norm() * other.e.norm();
  }
};

BiasError gyro_bias_error(const MeasuredBiases& measured, const NavState& state) {
  return {measured.gyro - state.gyro_bias, measured.gyro_sigma, measured.gyro_explained};
}

BiasError accel_bias_error(const MeasuredBiases& measured, const NavState& state) {
  return {measured.accel - state.accel_bias, measured.accel_sigma, measured.accel_explained};
}

bool is_certain(const VisualPose& pose, std::size_t tracked) {
  return pose.features >= kCertainFeatures && pose.features >= kCertainRatio * static_cast<double>(tracked);
}

/// Whether the newest errors of one sensor have one direction and fulfill a rule.
template <class ErrorOf>
bool fulfills(const StepRule& rule, const std::vector<MeasuredBiases>& measured, const ErrorOf& error_of) {
  if (measured.size() < rule.errors) return false;
  const BiasError newest = error_of(measured.back());
  bool explained = !rule.explained;
  for (std::size_t i = measured.size() - rule.errors; i < measured.size(); ++i) {
    const BiasError error = error_of(measured[i]);
    if (!error.exceeds(rule.limit) || !error.has_direction_of(newest)) return false;
    if (rule.certain && !measured[i].certain) return false;
    explained = explained || error.explained;
  }
  return explained;
}

bool is_step(const std::vector<MeasuredBiases>& measured, const NavState& state) {
  const auto gyro = [&](const StepRule& rule) {
    return fulfills(rule, measured, [&](const auto& biases) { return gyro_bias_error(biases, state); });
  };
  const auto accel = [&](const StepRule& rule) {
    return fulfills(rule, measured, [&](const auto& biases) { return accel_bias_error(biases, state); });
  };
  return std::ranges::any_of(kGyroRules, gyro) || std::ranges::any_of(kAccelRules, accel);
}

}  // namespace

BiasCheck::Result BiasCheck::update(const Window& window, ImuBuffer& imu) {
  if (!views_.add(window)) return Result::kUnknown;
  const std::optional<MeasuredBiases> newest = measure(window, imu);
  if (!newest) {
    measured_.clear();
    return Result::kUnknown;
  }
  if (!measured_.empty() && seconds_between(measured_.back().t, newest->t) > kMaxBiasPause_s)
    measured_.clear();
  if (measured_.size() == kMaxErrors) measured_.erase(measured_.begin());
  measured_.push_back(*newest);
  const NavState& state = window.frames.back().state;
  const BiasError gyro = gyro_bias_error(*newest, state), accel = accel_bias_error(*newest, state);
  const bool agrees = !gyro.exceeds(kGyroAgreement) && !accel.exceeds(kAccelAgreement);
  if (!agrees && is_step(measured_, state)) return Result::kStep;
  const bool differs = gyro.exceeds(kGyroDifference) || accel.exceeds(kAccelDifference);
  if (!newest->certain) return differs ? Result::kDoubtful : Result::kUnknown;
  if (agrees) return Result::kAgrees;
  return differs ? Result::kDiffers : Result::kUnknown;
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
  return MeasuredBiases{
      .t = C->t,
      .gyro = state.gyro_bias + error->gyro_b,
      .accel = state.accel_bias + B->T_w_b.q.conjugate() * error->accel_w,
      .gyro_sigma = error->gyro_sigma,
      .accel_sigma = error->accel_sigma,
      .certain = is_certain(*B, views_[*middle].points.size()) && is_certain(*C, views_[last].points.size()),
      .gyro_explained = error->gyro_is_explained(),
      .accel_explained = error->accel_is_explained()};
}

}  // namespace stillpoint
