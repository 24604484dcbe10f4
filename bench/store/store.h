// SPDX-License-Identifier: BSD-3-Clause
/// Reads a store: which runs were made, how they ended, their numbers, timings and trajectories.
///
///   const Store store("bench.sqlite");
///   for (const StoredRun& run : store.runs({.sequence = "walking_xyz"})) store.trajectory(run);
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/acceptance.h"
#include "bench/store/blob_files.h"
#include "bench/store/database.h"
#include "bench/store/stored_run.h"
#include "core/types/trajectory.h"

namespace stillpoint {

/// Which runs to read; what is empty matches all.
struct RunFilter {
  std::string system;
  std::string variant;
  std::string sequence;
  std::string build;  ///< or the beginning of one
  std::string kind;
};

/// A plan that was run into the store, and the keys of its runs in its order; some may not be made yet.
struct StoredPlan {
  std::string name;
  std::string title;
  std::string text;  ///< the TOML
  std::vector<std::string> run_keys;
};

/// The folder beside a store in which its files lie: FILE.files.
[[nodiscard]] std::filesystem::path files_folder(const std::filesystem::path& store_file);

class Store {
 public:
  /// Opens a store for reading; it may be written at the same time, and may lie where nothing can be written.
  /// @throws InputError if there is none, it is damaged, or a newer program's
  explicit Store(const std::filesystem::path& file);

  /// Ended runs, in the order in which they were begun.
  [[nodiscard]] std::vector<StoredRun> runs(const RunFilter& filter = {}) const;

  /// The ended runs of a plan, in its order.
  /// @throws InputError if the plan was not run into this store, naming those that were
  [[nodiscard]] std::vector<StoredRun> plan_runs(const std::string& plan) const;

  [[nodiscard]] std::vector<StoredPlan> plans() const;

  /// Changes of numbers that were accepted.
  [[nodiscard]] std::vector<Acceptance> acceptances() const;

  /// Number of runs that were begun and have not ended: being made, or broken off.
  [[nodiscard]] std::int64_t unfinished() const;

  /// JSON; empty if the run has none.
  [[nodiscard]] std::string manifest(const StoredRun& run) const;

  /// Empty if the run has none.
  /// @throws InputError if its file is missing or damaged
  [[nodiscard]] std::string attachment(const StoredRun& run, const std::string& kind) const;

  /// Poses T_w_c; no poses if the run has none.
  [[nodiscard]] Trajectory trajectory(const StoredRun& run) const;

  /// True poses T_w_c; none if the sequence has no ground truth, or an older program made the run.
  [[nodiscard]] Trajectory truth(const StoredRun& run) const;

  /// In order of frames; empty if they were not recorded.
  [[nodiscard]] std::vector<FrameCounters> frame_counters(const StoredRun& run) const;

  /// Every frame's time in every module, in order of frames; empty if they were not recorded.
  [[nodiscard]] std::vector<TimingSample> timing_samples(const StoredRun& run) const;

  [[nodiscard]] const std::filesystem::path& file() const { return database_.file(); }

 private:
  [[nodiscard]] Trajectory poses(const StoredRun& run, const std::string& kind) const;

  Database database_;
  BlobFiles blobs_;
};

}  // namespace stillpoint
