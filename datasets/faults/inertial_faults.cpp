// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/inertial_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Core>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kMinStep_ns = 1000;
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr double kStandardGravity = 9.80665;  // [m/s^2]
constexpr double kForcePerRate = 15.0;        // of vibrations: `SmootherConfig`, 0.15 m/s^2 and 0.01 rad/s

Eigen::Vector3d random_direction(synth::RandomSequence random) {
  const double z = random.normal(), y = random.normal(), x = random.normal();
  return Eigen::Vector3d(x, y, z).normalized();
}

Eigen::Vector3d clipped(const Eigen::Vector3d& value, double limit) {
  return value.cwiseMax(-limit).cwiseMin(limit);
}

Eigen::Vector3d random_normal(synth::RandomSequence& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

double random_sign(synth::RandomSequence& random) { return random.chance(0.5) ? 1.0 : -1.0; }

Eigen::Matrix3d random_signs(synth::RandomSequence& random) {
  Eigen::Matrix3d signs;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) signs(row, column) = random_sign(random);
  }
  return signs;
}

Eigen::Vector3d scaled(const Eigen::Vector3d& value, const SensorFault& fault) {
  synth::RandomSequence random = fault.random();
  const Eigen::Vector3d signs = random_signs(random).diagonal();
  return value + fault.amount / 100.0 * signs.cwiseProduct(value);
}

ImuSample misaligned(ImuSample sample, const SensorFault& fault) {
  synth::RandomSequence random = fault.random();
  const double angle = fault.amount * kRadiansPerDegree;
  for (Eigen::Vector3d* value : {&sample.gyro_b, &sample.accel_b}) {
    const Eigen::Matrix3d signs = random_signs(random);
    const Eigen::Vector3d error(signs(0, 1) * value->y() + signs(0, 2) * value->z(), signs(1, 2) * value->z(),
                                0.0);
    *value += angle * error;
  }
  return sample;
}

Eigen::Vector3d rate_of_force(const Eigen::Vector3d& force, const SensorFault& fault) {
  synth::RandomSequence random = fault.random();
  const double sensitivity = fault.amount * kRadiansPerDegree / kStandardGravity;
  return sensitivity / std::sqrt(3.0) * random_signs(random) * force;
}

ImuSample vibrating(ImuSample sample, const SensorFault& fault, double elapsed_s) {
  synth::RandomSequence random = fault.random();
  const Eigen::Vector3d accel_direction = random_normal(random).normalized();
  const Eigen::Vector3d gyro_direction = random_normal(random).normalized();
  const double rate = 2.0 * std::numbers::pi * random.uniform(40.0, 120.0);
  const double delay = random.uniform(0.0, 2.0 * std::numbers::pi);
  sample.accel_b += fault.amount * std::sin(rate * elapsed_s) * accel_direction;
  sample.gyro_b += fault.amount / kForcePerRate * std::sin(rate * elapsed_s + delay) * gyro_direction;
  return sample;
}

/// One active sample with an imperfection.
/// @param elapsed_s since the start of the fault
ImuSample imperfect(ImuSample sample, const SensorFault& fault, double elapsed_s) {
  constexpr double kPerMillion = 1e-6;
  switch (fault.kind) {
    case FaultKind::kGyroScale:
      sample.gyro_b = scaled(sample.gyro_b, fault);
      break;
    case FaultKind::kAccelScale:
      sample.accel_b = scaled(sample.accel_b, fault);
      break;
    case FaultKind::kImuMisalignment:
      return misaligned(sample, fault);
    case FaultKind::kGSensitivity:
      sample.gyro_b += rate_of_force(sample.accel_b, fault);
      break;
    case FaultKind::kImuVibration:
      return vibrating(sample, fault, elapsed_s);
    case FaultKind::kClockDrift:
      sample.t = after(sample.t, kPerMillion * fault.amount * elapsed_s);
      break;
    default:
      STILLPOINT_CHECK(false);
  }
  return sample;
}

/// One active sample with the fault.
/// @param elapsed_s since the start of the fault
ImuSample changed(ImuSample sample, const SensorFault& fault, double elapsed_s, std::size_t index) {
  switch (fault.kind) {
    case FaultKind::kGyroSaturated:
      sample.gyro_b = clipped(sample.gyro_b, fault.amount);
      break;
    case FaultKind::kAccelSaturated:
      sample.accel_b = clipped(sample.accel_b, fault.amount);
      break;
    case FaultKind::kGyroBias:
      sample.gyro_b.array() += fault.amount;
      break;
    case FaultKind::kAccelBias:
      sample.accel_b.array() += fault.amount;
      break;
    case FaultKind::kShock:
      sample.accel_b += fault.amount * random_direction(fault.random());
      break;
    case FaultKind::kImuJitter:
      sample.t = after(sample.t, fault.amount * fault.random(index).normal());
      break;
    case FaultKind::kTimeOffset:
    case FaultKind::kClockJump:
      sample.t = after(sample.t, fault.amount);
      break;
    default:
      return imperfect(sample, fault, elapsed_s);
  }
  return sample;
}

/// The first sample of each period of the lower rate.
std::vector<ImuSample> thinned(const std::vector<ImuSample>& samples, const SensorFault& fault,
                               Timestamp start) {
  constexpr double kRounding = 1e-6;  // of times that are multiples of the period
  std::vector<ImuSample> kept;
  double last_period = -1.0;
  for (const ImuSample& sample : samples) {
    const double elapsed_s = seconds_between(start, sample.t);
    const double period = std::floor((elapsed_s - fault.onset_s(elapsed_s)) * fault.amount + kRounding);
    const bool is_active = fault.is_active(elapsed_s);
    if (!is_active || period != last_period) kept.push_back(sample);
    last_period = is_active ? period : -1.0;
  }
  return kept;
}

/// White noise in addition to that of the stated densities.
ImuSample noisy(ImuSample sample, double interval_s, const ImuNoise& additional,
                synth::RandomSequence random) {
  const double per_root_s = 1.0 / std::sqrt(interval_s);
  sample.gyro_b += additional.gyro_noise * per_root_s * random_normal(random);
  sample.accel_b += additional.accel_noise * per_root_s * random_normal(random);
  return sample;
}

std::vector<ImuSample> with_noise(std::vector<ImuSample> samples, const SensorFault& fault, Timestamp start,
                                  const ImuNoise& stated) {
  const double ratio = std::sqrt(fault.amount * fault.amount - 1.0);
  const ImuNoise additional{.gyro_noise = ratio * stated.gyro_noise,
                            .accel_noise = ratio * stated.accel_noise};
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (!fault.is_active(seconds_between(start, samples[i].t))) continue;
    const double interval_s = seconds_between(samples[i - 1].t, samples[i].t);
    samples[i] = noisy(samples[i], interval_s, additional, fault.random(i + 1));
  }
  return samples;
}

}  // namespace

std::vector<ImuSample> samples_with_fault(std::vector<ImuSample> samples, const SensorFault& fault,
                                          Timestamp start, const ImuNoise& stated) {
  const auto is_active = [&](const ImuSample& sample) {
    const double elapsed_s = seconds_between(start, sample.t);
    return fault.kind == FaultKind::kClockJump ? elapsed_s >= fault.start_s : fault.is_active(elapsed_s);
  };
  if (fault.kind == FaultKind::kImuGap) {
    std::erase_if(samples, is_active);
    return samples;
  }
  if (fault.kind == FaultKind::kImuNoise) return with_noise(std::move(samples), fault, start, stated);
  if (fault.kind == FaultKind::kImuRate) return thinned(samples, fault, start);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_active(samples[i])) continue;
    samples[i] = changed(samples[i], fault, seconds_between(start, samples[i].t) - fault.start_s, i + 1);
  }
  for (std::size_t i = 1; i < samples.size(); ++i)
    samples[i].t.ns = std::max(samples[i].t.ns, samples[i - 1].t.ns + kMinStep_ns);
  return samples;
}

}  // namespace stillpoint::datasets
