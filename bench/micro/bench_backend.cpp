// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of the back end with a full inertial window: the marginalization of one frame, and one state
/// optimization of eight iterations with 150 landmarks, by Ceres and by the Schur solver.
#include <benchmark/benchmark.h>

#include "core/backend/sliding_window.h"
#include "core/backend/solvers/marginalization.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

constexpr auto kCeres = static_cast<std::int64_t>(WindowSolverKind::kCeres);
constexpr auto kSchur = static_cast<std::int64_t>(WindowSolverKind::kSchur);

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
    ->Arg(kCeres)
    ->Arg(kSchur)
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

void solve(benchmark::State& state, const BackendConfig& config) {
  const Window initial_window = simulated_window();
  const std::unique_ptr<WindowSolver> solver = make_window_solver(config.solver);
  SolveReport report;
  for (auto _ : state) {
    Window window = initial_window;
    report = solver->solve(window, config, kSimulatedFocal_px);
    benchmark::DoNotOptimize(window);
  }
  state.counters["landmarks"] = report.landmarks;
  state.counters["iterations"] = report.iterations - 1;  // the first entry is the initial state
  state.counters["cost"] = report.final_cost;
}

/// @param state range: solver
void solve_with_weighted_depth(benchmark::State& state) {
  BackendConfig config = simulated_window_config();
  config.solver = static_cast<WindowSolverKind>(state.range(0));
  solve(state, config);
}

void solve_with_fixed_depth(benchmark::State& state) {
  BackendConfig config = simulated_window_config();
  config.solver = static_cast<WindowSolverKind>(state.range(0));
  config.depth.usage = DepthUsage::kFixed;
  solve(state, config);
}

BENCHMARK(solve_with_weighted_depth)
    ->ArgName("schur")
    ->Arg(kCeres)
    ->Arg(kSchur)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(solve_with_fixed_depth)->ArgName("schur")->Arg(kCeres)->Arg(kSchur)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
