// SPDX-License-Identifier: BSD-3-Clause
/// Expected duration of the runs of a plan, from earlier runs in the store, and the order in which they are
/// started.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// Where an expected duration comes from, the most reliable first.
enum class CostSource {
  kSameRun,   ///< runs of the same variant on the same sequence
  kSequence,  ///< other variants on the same sequence
  kFrames,    ///< number of frames, at the median time per frame of all stored runs
  kAssumed,   ///< number of frames, at an assumed time per frame: the store is empty
};

struct RunCost {
  double seconds = 0.0;  ///< wall time of the process
  CostSource source = CostSource::kAssumed;
};

/// Expected durations of the runs of a matrix, in its order: medians of the metric `process_wall_s` of stored
/// runs in the same mode. The first source of `CostSource` that has data is used.
/// @param history runs of any build
[[nodiscard]] std::vector<RunCost> expected_costs(const PlanMatrix& matrix,
                                                  std::span<const StoredRun> history);

/// Wall time [s] of runs that `workers` workers start in the given order, each as soon as a worker is idle
/// (list scheduling; with the longest run first it is at most 4/3 of the optimum: Graham, SIAM J. Appl. Math.
/// 17, 1969).
[[nodiscard]] double scheduled_seconds(std::span<const double> run_seconds, int workers);

/// Divides a list of runs into at most `tasks` parts of consecutive runs with about equal sums, so that the
/// runs of a sequence remain together.
/// @return index of the first run of each part, and the number of runs; every part has at least one run
[[nodiscard]] std::vector<std::size_t> divide_evenly(std::span<const double> run_seconds, int tasks);

/// Indices of the runs whose sequences are available. Long runs are first, so that the last run does not wait
/// alone; the runs of a sequence remain together, as they share its cached files, and sequences are sorted
/// by their longest run. Timing runs, and runs that are executed one at a time, keep the order of the plan,
/// which alternates the variants.
/// @param history stored runs from which the durations are expected
/// @param jobs number of concurrent runs
[[nodiscard]] std::vector<std::size_t> execution_order(const PlanMatrix& matrix,
                                                       std::span<const StoredRun> history, int jobs);

}  // namespace stillpoint::bench
