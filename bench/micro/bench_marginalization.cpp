// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of the marginalization of one frame of a full inertial window.
#include <benchmark/benchmark.h>

#include "core/backend/marginalization/frame_marginalizer.h"
#include "core/backend/solvers/window_solver.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

/// @param state range: solver
void marginalize_oldest_frame(benchmark::State& state) {
  const Window window = simulated_window();
  BackendConfig config = simulated_window_config();
  config.solver = static_cast<WindowSolverKind>(state.range(0));
  const std::unique_ptr<WindowSolver> solver = make_window_solver(config.solver);
  LinearPrior prior;
  for (auto _ : state) {
    prior = solver->marginalize_oldest(window, config, kSimulatedFocal_px, std::move(prior));
    benchmark::DoNotOptimize(prior);
  }
}
BENCHMARK(marginalize_oldest_frame)
    ->ArgName("schur")
    ->Arg(static_cast<std::int64_t>(WindowSolverKind::kCeres))
    ->Arg(static_cast<std::int64_t>(WindowSolverKind::kSchur))
    ->Unit(benchmark::kMillisecond);

void marginalize_second_newest_frame(benchmark::State& state) {
  const Window window = simulated_window();
  const BackendConfig config = simulated_window_config();
  const LinearPrior prior =
      make_window_solver(config.solver)->marginalize_oldest(window, config, kSimulatedFocal_px, {});
  const int newest = prior.blocks.back().frame;
  FrameMarginalizer marginalizer;
  LinearPrior remaining;
  for (auto _ : state) {
    remaining = prior;
    remaining = marginalizer.remove(newest, std::move(remaining));
    benchmark::DoNotOptimize(remaining);
  }
}
BENCHMARK(marginalize_second_newest_frame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
