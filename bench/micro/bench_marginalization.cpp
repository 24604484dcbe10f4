// SPDX-License-Identifier: BSD-3-Clause
/// Cost of taking one frame out of a full inertial window.
#include <benchmark/benchmark.h>

#include "core/backend/marginalization.h"
#include "core/backend/schur/schur_solver.h"
#include "tests/support/flown_window.h"

namespace stillpoint {
namespace {

/// @param state range: solver
void marginalize_oldest_frame(benchmark::State& state) {
  const Window window = flown_window();
  BackendConfig config = flown_config();
  config.solver = static_cast<WindowSolverKind>(state.range(0));
  SchurSolver memory;
  for (auto _ : state) benchmark::DoNotOptimize(marginalize_oldest(window, config, kFlownFocal_px, memory));
}
BENCHMARK(marginalize_oldest_frame)
    ->ArgName("schur")
    ->Arg(static_cast<std::int64_t>(WindowSolverKind::kCeres))
    ->Arg(static_cast<std::int64_t>(WindowSolverKind::kSchur))
    ->Unit(benchmark::kMillisecond);

void marginalize_second_newest_frame(benchmark::State& state) {
  const Window window = flown_window();
  const LinearPrior prior = marginalize_oldest(window, flown_config(), kFlownFocal_px);
  const int newest = prior.blocks.back().frame;
  FrameMarginalizer memory;
  LinearPrior left;
  for (auto _ : state) {
    left = prior;
    memory.remove(newest, left);
    benchmark::DoNotOptimize(left);
  }
}
BENCHMARK(marginalize_second_newest_frame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
