// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/imu_model.h"

#include <cmath>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

struct AxisNoise {
  double rate_hz, density, walk, bias, phase;
};

Eigen::Vector3d normal3(RandomSequence& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

struct ReadingTimes {
  Timestamp first_stamp;  ///< of path time `from_s`
  double from_s, to_s;
};

template <class Ideal>
std::vector<datasets::VectorSample> simulate_readings(const Ideal& ideal, const AxisNoise& noise,
                                                      const ReadingTimes& times, RandomSequence random) {
  const auto& [first_stamp, from_s, to_s] = times;
  const double step_s = 1.0 / noise.rate_hz;
  const double white =
      noise.density * std::sqrt(noise.rate_hz);  // per-sample standard deviation: density / sqrt(dt)
  const double walk = noise.walk * std::sqrt(step_s);
  Eigen::Vector3d bias = noise.bias * normal3(random);
  std::vector<datasets::VectorSample> samples;
  for (int i = 0;; ++i) {
    const double since_start_s = (i + noise.phase) * step_s;
    if (from_s + since_start_s > to_s) return samples;
    const Eigen::Vector3d value = ideal(from_s + since_start_s) + bias + white * normal3(random);
    samples.push_back({after(first_stamp, since_start_s), value});
    bias += walk * normal3(random);
  }
}

}  // namespace

ImuRecord simulate_imu(const PathSpline& path, const ImuSensor& sensor, const ImuInterval& interval) {
  const Timestamp first_stamp = after(interval.epoch, interval.from_s + sensor.time_offset_s);
  const ReadingTimes times{first_stamp, interval.from_s, interval.to_s};
  const ImuNoise& noise = sensor.noise;
  const AxisNoise gyro{sensor.gyro_rate_hz, noise.gyro_noise, noise.gyro_walk, sensor.gyro_bias, 0.28};
  const AxisNoise accel{sensor.accel_rate_hz, noise.accel_noise, noise.accel_walk, sensor.accel_bias, 0.325};
  ImuRecord record;
  record.gyro = simulate_readings([&](double t_s) { return path.at(t_s).rate_b; }, gyro, times,
                                  RandomSequence(random_key(interval.seed, RandomStream::kGyro)));
  record.accel = simulate_readings([&](double t_s) { return specific_force(path.at(t_s)); }, accel, times,
                                   RandomSequence(random_key(interval.seed, RandomStream::kAccel)));
  return record;
}

}  // namespace stillpoint::synth
