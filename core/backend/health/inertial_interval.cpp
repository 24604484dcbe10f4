// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_interval.h"

#include <algorithm>
#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

constexpr double kRounding = 1e-12;

/// Whether one axis is at the limit for some samples, while the others vary.
template <class Vector>
bool is_saturated(std::span<const ImuSample> samples, double limit, const Vector& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    int at_limit = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      at_limit = std::abs(vector(samples[i])[axis]) == limit ? at_limit + 1 : 0;
      if (at_limit >= kMonitor.samples.saturated_samples && vector(samples[i]) != vector(samples[i - 1]))
        return true;
    }
  }
  return false;
}

}  // namespace

ImuNoise unreliable_noise(const ImuNoise& noise) {
  return {.gyro_noise = std::max(noise.gyro_noise, kMonitor.samples.unreliable_gyro),
          .accel_noise = std::max(noise.accel_noise, kMonitor.samples.unreliable_accel),
          .gyro_walk = noise.gyro_walk,
          .accel_walk = noise.accel_walk};
}

/// Interpolated samples at the ends of an interval have rounding errors.
bool SampleInspector::has_plateau(std::span<const ImuSample> samples) {
  bool found = false;
  for (const ImuSample& sample : samples) {
    for (std::size_t i = 0; i < plateaus_.size(); ++i) {
      const auto axis = static_cast<Eigen::Index>(i % 3);
      const Eigen::Vector3d& values = i < 3 ? sample.gyro_b : sample.accel_b;
      const Eigen::Vector3d& last = i < 3 ? last_gyro_ : last_accel_;
      Plateau& plateau = plateaus_[i];
      if (!(std::abs(values[axis] - plateau.value) <= kRounding * std::abs(plateau.value)))
        plateau = {.value = values[axis], .begin = sample.t};
      ++plateau.samples;
      plateau.others_vary |= plateau.samples > 1 && (values - last).norm() > 1e-6;
      found |= plateau.samples >= kMonitor.samples.plateau_samples && plateau.value != 0.0 &&
               plateau.others_vary && seconds_between(plateau.begin, sample.t) >= kMonitor.samples.plateau_s;
    }
    last_gyro_ = sample.gyro_b;
    last_accel_ = sample.accel_b;
  }
  return found;
}

StatusReason SampleInspector::inspect(std::span<const ImuSample> samples, bool has_gap) {
  for (const ImuSample& sample : samples) {
    largest_gyro_ = std::max(largest_gyro_, sample.gyro_b.cwiseAbs().maxCoeff());
    largest_accel_ = std::max(largest_accel_, sample.accel_b.cwiseAbs().maxCoeff());
  }
  if (has_gap || samples.size() < 2) return StatusReason::kImuGap;
  const auto gyro = [](const ImuSample& sample) -> const Eigen::Vector3d& { return sample.gyro_b; };
  const auto accel = [](const ImuSample& sample) -> const Eigen::Vector3d& { return sample.accel_b; };
  const bool saturated = has_plateau(samples) || is_saturated(samples, largest_gyro_, gyro) ||
                         is_saturated(samples, largest_accel_, accel);
  return saturated ? StatusReason::kImuSaturated : StatusReason::kNone;
}

std::vector<ImuSample> constant_velocity_samples(const NavState& before, const Eigen::Vector3d& gravity_w,
                                                 Timestamp begin, Timestamp end) {
  const ImuSample sample{.t = begin,
                         .gyro_b = before.gyro_bias,
                         .accel_b = before.accel_bias - before.T_w_b.q.conjugate() * gravity_w};
  ImuSample last = sample;
  last.t = end;
  return {sample, last};
}

}  // namespace stillpoint
