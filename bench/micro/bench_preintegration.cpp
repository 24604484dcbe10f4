// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of preintegration and propagation; "items" are IMU samples.
#include <benchmark/benchmark.h>

#include "core/imu/imu_buffer.h"
#include "core/imu/preintegration.h"
#include "core/imu/propagation.h"

namespace stillpoint {
namespace {

/// Samples at 200 Hz with varying rates and specific forces; one more sample than intervals.
std::vector<ImuSample> samples_at_200_hz(std::int64_t intervals) {
  std::vector<ImuSample> samples;
  for (std::int64_t i = 0; i <= intervals; ++i) {
    const double t = static_cast<double>(i) / 200.0;
    samples.push_back({.t = from_seconds(t),
                       .gyro_b = {std::sin(2.0 * t), -std::cos(3.0 * t), 0.9},
                       .accel_b = {std::cos(4.0 * t), 9.0, 2.0 - std::sin(5.0 * t)}});
  }
  return samples;
}

void count_samples(benchmark::State& state) { state.SetItemsProcessed(state.iterations() * state.range(0)); }

void preintegrate(benchmark::State& state) {
  const std::vector<ImuSample> samples = samples_at_200_hz(state.range(0));
  for (auto _ : state) {
    Preintegration imu(ImuNoise{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    imu.integrate(samples);
    benchmark::DoNotOptimize(imu);
  }
  count_samples(state);
}
BENCHMARK(preintegrate)->Arg(7)->Arg(20)->Arg(100);  // frame intervals at 30 Hz and 10 Hz, and 0.5 s

void repropagate(benchmark::State& state) {
  Preintegration imu(ImuNoise{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  imu.integrate(samples_at_200_hz(state.range(0)));
  for (auto _ : state) {
    imu.repropagate({0.01, 0.02, 0.03}, {0.1, 0.2, 0.3});
    benchmark::DoNotOptimize(imu);
  }
  count_samples(state);
}
BENCHMARK(repropagate)->Arg(20);

void propagate_states(benchmark::State& state) {
  const std::vector<ImuSample> samples = samples_at_200_hz(state.range(0));
  for (auto _ : state) {
    NavState end = propagate(NavState{}, samples, {0.0, 0.0, -9.81});
    benchmark::DoNotOptimize(end);
  }
  count_samples(state);
}
BENCHMARK(propagate_states)->Arg(20);

void cut_buffer(benchmark::State& state) {
  ImuBuffer buffer;
  for (const ImuSample& sample : samples_at_200_hz(400)) buffer.add(sample);
  for (auto _ : state) {
    const std::vector<ImuSample>& cut = buffer.samples_between(from_seconds(1.0023), from_seconds(1.1023));
    benchmark::DoNotOptimize(cut.data());
  }
}
BENCHMARK(cut_buffer);

}  // namespace
}  // namespace stillpoint
