// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/imu_faults.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kMinStep_ns = 1000;

Eigen::Vector3d random_direction(synth::RandomSequence random) {
  const double z = random.normal(), y = random.normal(), x = random.normal();
  return Eigen::Vector3d(x, y, z).normalized();
}

Eigen::Vector3d clipped(const Eigen::Vector3d& value, double limit) {
  return value.cwiseMax(-limit).cwiseMin(limit);
}

/// One active sample with the fault.
ImuSample changed(ImuSample sample, const SensorFault& fault, std::size_t index) {
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
      STILLPOINT_CHECK(false);
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

}  // namespace

std::vector<ImuSample> samples_with_fault(std::vector<ImuSample> samples, const SensorFault& fault,
                                          Timestamp start) {
  const auto is_active = [&](const ImuSample& sample) {
    const double elapsed_s = seconds_between(start, sample.t);
    return fault.kind == FaultKind::kClockJump ? elapsed_s >= fault.start_s : fault.is_active(elapsed_s);
  };
  if (fault.kind == FaultKind::kImuGap) {
    std::erase_if(samples, is_active);
    return samples;
  }
  if (fault.kind == FaultKind::kImuRate) return thinned(samples, fault, start);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (is_active(samples[i])) samples[i] = changed(samples[i], fault, i + 1);
  }
  for (std::size_t i = 1; i < samples.size(); ++i)
    samples[i].t.ns = std::max(samples[i].t.ns, samples[i - 1].t.ns + kMinStep_ns);
  return samples;
}

}  // namespace stillpoint::datasets
