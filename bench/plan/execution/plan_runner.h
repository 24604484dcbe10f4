// SPDX-License-Identifier: BSD-3-Clause
/// Executes the runs of a plan that are not yet in the store, each in a child process, and measures where the
/// time of the plan goes.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "bench/model/stored_run.h"
#include "bench/plan/plan_matrix.h"
#include "bench/process/child_process.h"
#include "bench/store/store_writer.h"
#include "bench/systems/file_states.h"

namespace stillpoint::bench {

/// Where the time of a plan goes: odometry, images, start of processes, scoring, storing. Durations [s],
/// summed over the executed runs. A worker executes one run at a time; its time is divided among the first
/// group and waiting. The second group is spent on other threads, or while no run is executed.
struct HarnessProfile {
  std::size_t runs = 0;
  int workers = 1;
  double wall_s = 0.0;  ///< of the plan

  double odometry_s = 0.0;       ///< runs, without the next line
  double image_waits_s = 0.0;    ///< runs: the odometry waits for decoded images
  double start_s = 0.0;          ///< from the start of a process to its first frame
  double output_s = 0.0;         ///< from the last frame to the end of a process: scores and files
  double other_process_s = 0.0;  ///< processes without such times: external systems, failures, valgrind

  double decoding_s = 0.0;  ///< of decoding threads
  double rendering_s = 0.0;
  double preparing_s = 0.0;  ///< filling the frame cache, warm-up runs
  double scoring_s = 0.0;    ///< reading results, additional protocols
  double storing_s = 0.0;

  /// Time in which workers execute no run.
  [[nodiscard]] double idle_s() const;
};

/// Adds the process of one run.
[[nodiscard]] HarnessProfile with_run(HarnessProfile profile, const ProcessResult& process,
                                      const RunOutcome& outcome);

/// A table of all durations, with their share of workers x wall time.
[[nodiscard]] std::string profile_text(const HarnessProfile& profile);

/// The members as JSON.
[[nodiscard]] std::string profile_json(const HarnessProfile& profile);

/// Measures from its construction on.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Checks that the recorded sequences of a plan have the boxes that its configs require.
/// @throws InputError naming the first run whose sequence has no detections.txt although its config uses
/// recorded boxes; runs of external systems and of other programs are not checked
void require_recorded_boxes(const PlanMatrix& matrix);

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

/// Requires that the recorded sequences of a plan are as at the first call with this watch: a plan that is
/// executed several times has the keys of its expansion.
/// @throws InputError if a file of one has changed
void require_unchanged_sequences(SequenceWatch& watch, const PlanMatrix& matrix);

}  // namespace stillpoint::bench
