// SPDX-License-Identifier: BSD-3-Clause
/// Simulates the execution of a plan by many workers: what limits the speedup, and how large a plan must be.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillpoint::bench {

struct SimulatedRun {
  double seconds = 0.0;
  std::size_t sequence = 0;
};

/// Times other than those of runs [s].
struct ScalingCosts {
  double task_start_s = 2.0;  ///< start of a task: scheduler, connection, opening the store
  double merge_s = 0.17;      ///< `store merge` per run with annotated images, reports/measured/scaling.md
  double prepare_s = 30.0;    ///< a sequence on a worker that does not have it: copying, rendering, decoding
  double variation = 0.1;     ///< of the duration of runs: uniform within 1 +- variation
};

/// Wall time of a plan as a sum [s]. All but the last two are averages over the workers.
struct SimulatedPlan {
  std::size_t runs = 0;
  double executing_s = 0.0;
  double starting_s = 0.0;
  double preparing_s = 0.0;
  double waiting_s = 0.0;  ///< for the last task
  double merging_s = 0.0;  ///< by one process, after the last task

  [[nodiscard]] double wall_s() const {
    return executing_s + starting_s + preparing_s + waiting_s + merging_s;
  }
  /// Fraction of the time of the workers in which they execute runs.
  [[nodiscard]] double efficiency() const { return executing_s / wall_s(); }
};

/// Each run `times` times in succession, as further variants or repetitions of its sequence.
[[nodiscard]] std::vector<SimulatedRun> repeated(std::span<const SimulatedRun> runs, std::size_t times);

/// Divides the runs into tasks as the executors do (`divide_evenly`). Each idle worker takes the next task,
/// prepares the sequences that it has not had before, and executes the runs. Deterministic.
/// @param runs not empty, with positive durations
[[nodiscard]] SimulatedPlan simulate_plan(std::span<const SimulatedRun> runs, int workers, int tasks,
                                          const ScalingCosts& costs);

}  // namespace stillpoint::bench
