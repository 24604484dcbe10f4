// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of the marginalization of one frame of a full inertial window.
#include <benchmark/benchmark.h>

#include "core/backend/marginalization/marginalization.h"
#include "core/backend/solvers/schur_solver.h"
#include "tests/support/simulated_window.h"

namespace stillpoint {
namespace {

/// @param state range: solver
void marginalize_oldest_frame(benchmark::State& state) {
  const Window window = simulated_window();
  BackendConfig config = simulated_window_config();
  config.solver = static_cast<WindowSolverKind>(state.range(0));
  SchurSolver solver;
  for (auto _ : state)
    benchmark::DoNotOptimize(marginalize_oldest(window, config, kSimulatedFocal_px, solver));
}
BENCHMARK(marginalize_oldest_frame)
    ->ArgName("schur")
    ->Arg(static_cast<std::int64_t>(WindowSolverKind::kCeres))
    ->Arg(static_cast<std::int64_t>(WindowSolverKind::kSchur))
    ->Unit(benchmark::kMillisecond);

void marginalize_second_newest_frame(benchmark::State& state) {
  const Window window = simulated_window();
  const LinearPrior prior = marginalize_oldest(window, simulated_window_config(), kSimulatedFocal_px);
  const int newest = prior.blocks.back().frame;
  FrameMarginalizer marginalizer;
  LinearPrior remaining;
  for (auto _ : state) {
    remaining = prior;
    marginalizer.remove(newest, remaining);
    benchmark::DoNotOptimize(remaining);
  }
}
BENCHMARK(marginalize_second_newest_frame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
