// SPDX-License-Identifier: BSD-3-Clause
/// Executes the runs of a plan that are not yet in the store, each in a child process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "bench/plan/execution/harness_profile.h"
#include "bench/plan/plan_matrix.h"
#include "bench/store/store_writer.h"

namespace stillpoint::bench {

struct PlanHooks {
  std::function<void(const std::string& step)> on_step = {};  ///< before each rendering and each run
  std::function<void(int done, int total)> on_rendered = {};  ///< after each frame of a rendering
  std::function<void(std::size_t done, std::size_t total)> on_progress = {};  ///< after each run
  std::function<bool()> stop_requested = {};
};

struct PlanOptions {
  int jobs = 1;        ///< concurrent accuracy runs; timing runs always execute one at a time
  bool retry = false;  ///< execute runs again that did not succeed
  bool record = true;  ///< store the plan; workers that execute a part of a plan do not
};

/// Numbers of runs by what `run_plan` did with them.
struct PlanReport {
  std::size_t executed = 0;
  std::size_t cached = 0;   ///< already in the store, or executed by another worker in the meantime
  std::size_t missing = 0;  ///< skipped, as their sequence is not available
  bool interrupted = false;
  HarnessProfile profile;  ///< of the executed runs
};

/// Prepares a store for the execution of a plan: removes runs that are to be executed again, and stores the
/// plan if `options.record` is set. `run_plan` does this itself.
void prepare_store(const PlanMatrix& matrix, StoreWriter& writer, const PlanOptions& options);

/// Executes every run of the matrix that is not completed yet, and stores each as soon as it ends. Runs with
/// outcome "bad_data" are executed again. Several workers may execute the same plan: runs leased by another
/// worker are waited for.
/// @throws InputError if a recorded sequence lacks the boxes that a config uses, before the first run; or if
/// the store can no longer be written, completed runs remain stored
[[nodiscard]] PlanReport run_plan(const PlanMatrix& matrix, StoreWriter& writer, const PlanOptions& options,
                                  const PlanHooks& hooks);

}  // namespace stillpoint::bench
