// SPDX-License-Identifier: BSD-3-Clause
/// Benchmark of the pose graph: 10,000 keyframes with 500 loops, of which a tenth is false.
#include <benchmark/benchmark.h>

#include "tests/support/simulated/simulated_pose_graph.h"

namespace stillpoint {
namespace {

/// @param state ranges: keyframes, loops
void optimize_graph(benchmark::State& state) {
  const auto loops = static_cast<int>(state.range(1));
  const SimulatedPoseGraph simulated = simulated_pose_graph({.keyframes = static_cast<int>(state.range(0)),
                                                             .keyframes_per_lap = 500,
                                                             .loops = loops,
                                                             .false_every = 10,
                                                             .gravity = true});
  PoseGraphSolution solution;
  for (auto _ : state) solution = optimize_pose_graph(simulated.graph, {});
  for (std::size_t i = 0; i < solution.inliers.size(); ++i) {
    state.counters["accepted_false"] += solution.inliers[i] && !simulated.true_loops[i];
    state.counters["refused_true"] += !solution.inliers[i] && simulated.true_loops[i];
  }
  state.counters["error_m"] = largest_error_m(solution.T_m_b, simulated.truth);
}

BENCHMARK(optimize_graph)->Args({1000, 50})->Args({10000, 500})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
