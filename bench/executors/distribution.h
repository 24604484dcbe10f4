// SPDX-License-Identifier: BSD-3-Clause
/// Executes a plan in tasks: the missing runs are divided, executed by workers with stores of their own, and
/// merged. Each step may be interrupted at any time: the next call collects what was completed, and executes
/// the rest.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

struct DistributionOptions {
  std::filesystem::path store;
  int tasks = 4;              ///< at most; fewer if there are fewer runs
  int jobs = 1;               ///< concurrent accuracy runs of a task
  bool retry = false;         ///< execute runs again that did not succeed
  std::string machine_class;  ///< required for timing runs
  std::function<void(const std::string& step)> on_step = {};
  std::function<bool()> stop_requested = {};
};

/// How tasks are executed.
struct Executor {
  /// Waits for workers of an earlier call, and merges their stores into that of the plan.
  std::function<void()> collect;
  /// Executes the tasks 1 to `tasks` of the job folder. Failed tasks are not an error: their runs are
  /// missing.
  std::function<void(int tasks)> execute;
};

/// The job folder of a plan: STORE.jobs/KEY, where the key identifies the plan, its store and this machine.
/// @return an absolute path; the folder exists
[[nodiscard]] std::filesystem::path job_folder(const BenchPlan& plan, const std::filesystem::path& store);

/// Waits while another process distributes the same plan into the same store.
/// @throws InputError if timing runs have no machine class, if a recorded sequence lacks boxes that a config
/// uses, or as the executor
[[nodiscard]] PlanReport distribute_plan(const PlanMatrix& matrix, const DistributionOptions& options,
                                         const Executor& executor);

}  // namespace stillpoint::bench
