// SPDX-License-Identifier: BSD-3-Clause
/// Executes a plan in tasks: the missing runs are divided, executed by workers with stores of their own, and
/// merged. Each step may be interrupted at any time: the next call collects what was completed, and executes
/// the rest. A simulation tells what limits the speedup, and how large a plan must be.
///
/// The workers, on this or on other machines, share a job folder. It contains
///   plan.toml        the plan
///   systems          names of the other systems, one per line, in the order of the plan; optional
///   files            configs and sequences that the plan names by paths: the path, and on the next line
///                    its place relative to the job folder; optional
///   config-I/        copy of a config with the files that it inherits; optional
///   system-I/        copy of the description of system I = 0, 1, ..., with its template and the files of its
///                    command; optional
///   build            of the program that divided the plan
///   keys-K           keys of the runs of task K = 1, 2, ..., one per line
///   store-K.sqlite   the store of task K, with its files
///   data/            recorded sequences that were copied to this machine; optional
///   lock             shared lock of every worker
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"
#include "bench/store/maintenance/maintenance.h"

namespace stillpoint::bench {

/// Where workers find configs, descriptions of other systems and the files of their commands.
enum class SystemFiles {
  kCopied,  ///< in the job folder
  kShared,  ///< by the paths of this machine
};

/// Writes the job of a plan into a folder, instead of an earlier one; existing stores remain.
/// @param tasks keys of the runs of each task
/// @throws InputError if the folder cannot be written, or a description cannot be read or cannot be copied,
/// because it needs a folder, or a file that is not below its own folder
void write_job(const std::filesystem::path& folder, const BenchPlan& plan,
               const std::vector<std::vector<std::string>>& tasks, SystemFiles system_files);

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

/// How a plan is divided.
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
  SystemFiles system_files = SystemFiles::kCopied;
};

/// The job folder of a plan: STORE.jobs/KEY, where the key identifies the plan, its store and this machine.
/// @return an absolute path; the folder exists
[[nodiscard]] std::filesystem::path job_folder(const BenchPlan& plan, const std::filesystem::path& store);

/// Divides a plan, executes its tasks and merges their stores. Waits while another process distributes the
/// same plan into the same store.
/// @throws InputError if timing runs have no machine class, if a recorded sequence lacks boxes that a config
/// uses, or as the executor
[[nodiscard]] PlanReport distribute_plan(const PlanMatrix& matrix, const DistributionOptions& options,
                                         const Executor& executor);

/// A run of a plan whose execution by many workers is simulated.
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
