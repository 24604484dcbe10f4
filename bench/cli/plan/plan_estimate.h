// SPDX-License-Identifier: BSD-3-Clause
/// How long the runs of a plan take that are not in the store, for `stillpoint bench --estimate`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/executors/distribution.h"
#include "bench/plan/execution/run_cost.h"
#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// What executes the runs of an estimate.
struct EstimatedWorkers {
  int jobs = 1;       ///< concurrent accuracy runs on this machine
  int tasks = 0;      ///< of an executor; 0 = none
  int simulated = 0;  ///< workers of a simulation; 0 = none
};

/// Execution by tasks as `divide_evenly` makes them.
struct TaskEstimate {
  int tasks = 0;
  double wall_s = 0.0;   ///< the longest task, and the merge of all runs by one process
  double merge_s = 0.0;  ///< part of `wall_s`
  double speedup = 0.0;  ///< against one worker
};

struct PlanEstimate {
  std::size_t runs = 0;          ///< of the plan
  std::vector<RunCost> pending;  ///< of the runs that are not in the store and have their sequence
  int jobs = 1;
  double one_worker_s = 0.0;
  double wall_s = 0.0;              ///< with `jobs` at once
  std::vector<TaskEstimate> tasks;  ///< 1, 2, 4, ... up to the number of tasks
  int simulated_workers = 0, simulated_tasks = 0;
  std::vector<SimulatedPlan> simulation;  ///< the plan and its multiples
};

/// Expected wall time, and what the expectation is based on. Rendering of sequences is not included.
/// @param store need not exist
/// @param workers `tasks` > 0 adds the expected wall times with 1, 2, 4, ... up to that many tasks;
/// `simulated` > 0 adds a simulation of the plan and of its multiples with as many tasks as workers, or
/// `tasks`
[[nodiscard]] PlanEstimate estimate_plan(const PlanMatrix& matrix, const std::filesystem::path& store,
                                         const EstimatedWorkers& workers);

[[nodiscard]] std::string estimate_text(const PlanEstimate& estimate);

/// The schema is bench_estimate.
[[nodiscard]] std::string estimate_json(const PlanEstimate& estimate);

}  // namespace stillpoint::bench
