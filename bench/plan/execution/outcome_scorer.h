// SPDX-License-Identifier: BSD-3-Clause
/// Derives the stored outcome of a run from its finished process, and scores completed runs and writes their
/// files on other threads, so that a worker never waits for them.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <string>

#include "bench/plan/bench_plan.h"
#include "bench/process/child_process.h"
#include "bench/store/store_writer.h"
#include "bench/systems/slam_system.h"

namespace stillpoint::bench {

/// The outcome reported by the system, or the limit or signal that terminated it, together with the resource
/// usage of the process and the metrics of the plan's evaluation protocols.
[[nodiscard]] RunOutcome outcome_of_run(const SlamSystem& system, const RunRequest& request,
                                        const ProcessResult& end, const BenchPlan& plan);

/// The outcome `bad_data`, without results, if files of the sequence were changed during the run.
/// @param outcome as if nothing had changed
/// @param changes of `SequenceWatch`
[[nodiscard]] RunOutcome unless_changed(RunOutcome outcome, const std::string& changes);

/// A run that is ready to be stored.
struct ScoredRun {
  std::size_t run = 0;
  ProcessResult process;
  RunOutcome outcome;
  double scoring_s = 0.0;
  double writing_s = 0.0;  ///< of the attachments
};

/// Scores completed runs on other threads.
class OutcomeScorer {
 public:
  /// @param writer must outlive this object; only `write_files` is called on other threads
  explicit OutcomeScorer(const StoreWriter& writer) : writer_(writer) {}

  /// @param score reads and scores the results of the run, on another thread
  void start(std::size_t run, const ProcessResult& process, std::function<RunOutcome()> score);

  [[nodiscard]] std::size_t pending() const { return scored_.size(); }

  /// Whether `take` returns at once.
  [[nodiscard]] bool is_finished() const;

  /// Waits for the run that was started first.
  /// @throws InputError if the store cannot be written
  [[nodiscard]] ScoredRun take();

 private:
  const StoreWriter& writer_;
  std::deque<std::future<ScoredRun>> scored_;  ///< in the order of `start`
};

}  // namespace stillpoint::bench
