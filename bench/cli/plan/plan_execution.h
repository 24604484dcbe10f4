// SPDX-License-Identifier: BSD-3-Clause
/// Execution of a plan by a command: where its runs are executed, and progress output on the console.
#pragma once

#include <string>
#include <vector>

#include "bench/cli/command_line.h"
#include "bench/plan/execution/plan_runner.h"

namespace stillpoint::bench {

/// Hooks that log each step and draw progress lines for renderings and runs on stderr. They stop the plan on
/// SIGINT and SIGTERM.
[[nodiscard]] PlanHooks plan_progress();

/// Options of `bench` that select where the runs of a plan are executed.
struct ExecutionArguments {
  std::string executor = "local";
  std::string hosts;
  std::string ssh_config;
  std::string machine_class;
  int tasks = 0;  ///< 0 = default of the executor
};

/// @param arguments target of the options; must outlive them
[[nodiscard]] std::vector<Option> execution_options(ExecutionArguments& arguments);

/// Number of concurrent accuracy runs on this machine.
/// @param jobs 0 = as many as processors are available
[[nodiscard]] int local_jobs(int jobs);

/// Executes the missing runs of a plan, on this machine or by tasks on others.
/// @param options `jobs` = 0: all processors; with tasks one run at a time in each
/// @throws InputError for options that the executor does not have, and as `run_plan` and the executors
[[nodiscard]] PlanReport execute_plan(const PlanMatrix& matrix, const std::string& store,
                                      const PlanOptions& options, const ExecutionArguments& arguments);

}  // namespace stillpoint::bench
