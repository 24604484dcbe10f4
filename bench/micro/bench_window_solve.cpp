// SPDX-License-Identifier: BSD-3-Clause
/// Cost of one state optimisation: eight iterations over a full inertial window.
#include <benchmark/benchmark.h>

#include "bench/micro/flown_window.h"

namespace stillpoint {
namespace {

void solve_with_weighted_depth(benchmark::State& state) {
  const Window start = flown_window();
  const BackendConfig config = flown_config();
  SolveReport report;
  for (auto _ : state) {
    Window window = start;
    report = solve_window(window, config, kFlownFocal_px);
    benchmark::DoNotOptimize(window);
  }
  state.counters["landmarks"] = report.landmarks;
  state.counters["iterations"] = report.iterations;
}
BENCHMARK(solve_with_weighted_depth)->Unit(benchmark::kMillisecond);

void solve_with_fixed_depth(benchmark::State& state) {
  const Window start = flown_window();
  BackendConfig config = flown_config();
  config.depth.usage = DepthUsage::kFixed;
  for (auto _ : state) {
    Window window = start;
    benchmark::DoNotOptimize(solve_window(window, config, kFlownFocal_px));
  }
}
BENCHMARK(solve_with_fixed_depth)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
