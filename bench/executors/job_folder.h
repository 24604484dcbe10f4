// SPDX-License-Identifier: BSD-3-Clause
/// A folder with which several workers execute a plan, on this or on other machines. It contains
///   plan.toml        the plan
///   build            of the program that divided the plan
///   keys-K           keys of the runs of task K = 1, 2, ..., one per line
///   store-K.sqlite   the store of task K, with its files
///   data/            recorded sequences that were copied to this machine; optional
///   lock             shared lock of every worker
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"
#include "bench/store/maintenance/run_transfer.h"

namespace stillpoint::bench {

/// Replaces the job in a folder; existing stores remain.
/// @param tasks keys of the runs of each task
/// @throws InputError if the folder cannot be written
void write_job(const std::filesystem::path& folder, const BenchPlan& plan,
               const std::vector<std::vector<std::string>>& tasks);

/// The matrix of a plan, restricted to the runs with the given keys. A key contains the checksum of the
/// sequence, the config and the build, so a machine where one of them differs does not have the run.
/// @throws InputError if a key is not one of the plan on this machine, or as `load_plan` and `expand_plan`
[[nodiscard]] PlanMatrix job_matrix(const std::filesystem::path& folder,
                                    const std::vector<std::string>& keys);

/// Keys of one task, or of all tasks.
/// @throws InputError if there is no such task
[[nodiscard]] std::vector<std::string> task_keys(const std::filesystem::path& folder, int task);
[[nodiscard]] std::vector<std::string> all_task_keys(const std::filesystem::path& folder);

/// Executes a task into its own store. Completed runs of an earlier execution of the task are not repeated.
[[nodiscard]] PlanReport run_task(const std::filesystem::path& folder, int task, int jobs,
                                  const PlanHooks& hooks);

/// Returns when no worker uses the folder.
void wait_for_workers(const std::filesystem::path& folder);

/// Waits for the workers of a folder, adds the runs of all stores of tasks to `store`, and removes them. May
/// be repeated after an interruption.
MergeReport merge_tasks(const std::filesystem::path& folder, const std::filesystem::path& store);

}  // namespace stillpoint::bench
