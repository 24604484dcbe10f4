// SPDX-License-Identifier: BSD-3-Clause
/// Reads a store: runs with their outcomes, metrics, timings and trajectories.
///
///   const Store store("bench.sqlite");
///   for (const StoredRun& run : store.runs({.sequence = "walking_xyz"})) store.trajectory(run);
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/store/blob_files.h"
#include "bench/store/database.h"
#include "core/types/trajectory.h"

namespace stillpoint::bench {

/// A reviewed and accepted change of a metric at a commit; an empty variant or sequence matches all.
struct Acceptance {
  std::string commit;
  std::string metric;  ///< name of a metric or of a module
  std::string variant;
  std::string sequence;
  std::string reason;
  std::string accepted;  ///< UTC, ISO 8601
};

/// Selects runs; an empty member matches all.
struct RunFilter {
  std::string system;
  std::string variant;
  std::string sequence;
  std::string build;  ///< a build or a prefix of it
  std::string kind;
};

/// A plan that was executed into the store, and the keys of its runs in plan order; some may not be executed
/// yet.
struct StoredPlan {
  std::string name;
  std::string title;
  std::string text;  ///< the TOML
  std::vector<std::string> run_keys;
};

/// The folder with the files of a store: FILE.files.
[[nodiscard]] std::filesystem::path files_folder(const std::filesystem::path& store_file);

class Store {
 public:
  /// Opens a store for reading. It may be written at the same time, and its folder may be read-only.
  /// @throws InputError if there is none, it is damaged, or was written by a newer version
  explicit Store(const std::filesystem::path& file);

  /// Completed runs, in the order of their start; those that were merged into the store keep their times.
  [[nodiscard]] std::vector<StoredRun> runs(const RunFilter& filter = {}) const;

  /// As `runs`, without metrics, costs and files: small also for 10^5 runs.
  [[nodiscard]] std::vector<StoredRun> run_headers(const RunFilter& filter = {}) const;

  /// The runs with their metrics, costs and files, which are read anew.
  [[nodiscard]] std::vector<StoredRun> with_details(std::vector<StoredRun> runs) const;

  /// The completed runs of a plan, in its order.
  /// @throws InputError if the store does not contain the plan; the message lists those that it contains
  [[nodiscard]] std::vector<StoredRun> plan_runs(const std::string& plan) const;

  [[nodiscard]] std::vector<StoredPlan> plans() const;

  /// Accepted changes of metrics, sorted by commit, metric, variant and sequence. A store of schema 1 has
  /// none.
  [[nodiscard]] std::vector<Acceptance> acceptances() const;

  /// Number of runs without an outcome: running, or interrupted.
  [[nodiscard]] std::int64_t unfinished() const;

  /// JSON; empty if the run has none.
  [[nodiscard]] std::string manifest(const StoredRun& run) const;

  /// Empty if the run has none.
  /// @throws InputError if its file is missing or damaged
  [[nodiscard]] std::string attachment(const StoredRun& run, const std::string& kind) const;

  /// Estimated poses T_w_c; empty if the run has none.
  [[nodiscard]] Trajectory trajectory(const StoredRun& run) const;

  /// Ground-truth poses T_w_c; empty if the sequence has no ground truth, or the run was recorded by an older
  /// version.
  [[nodiscard]] Trajectory truth(const StoredRun& run) const;

  /// In order of frames; empty if they were not recorded.
  [[nodiscard]] std::vector<FrameCounters> frame_counters(const StoredRun& run) const;

  /// Time per frame and module, in order of frames; empty if it was not recorded.
  [[nodiscard]] std::vector<TimingSample> timing_samples(const StoredRun& run) const;

  [[nodiscard]] const std::filesystem::path& file() const { return database_.file(); }

 private:
  [[nodiscard]] Trajectory poses(const StoredRun& run, const std::string& kind) const;

  Database database_;
  BlobFiles blobs_;
};

/// Adds acceptances to a store; one of the same commit, metric, variant and sequence is replaced. An older
/// store is migrated.
/// @throws InputError if there is no such store, or it cannot be written
void write_acceptances(const std::filesystem::path& file, const std::vector<Acceptance>& acceptances);

/// Removes an acceptance; its reason and time are ignored. @return false if there was none
[[nodiscard]] bool withdraw_acceptance(const std::filesystem::path& file, const Acceptance& acceptance);

/// Runs of a store of which some attached files may be missing or damaged.
struct ReadableRuns {
  std::vector<StoredRun> runs;    ///< without the unreadable files
  std::vector<std::string> gaps;  ///< one line per run with unreadable files
};

/// Reads all files of the runs, and removes the entries of those that are missing or damaged, so that readers
/// find them absent. The details of these runs name them.
[[nodiscard]] ReadableRuns without_unreadable_files(const Store& store, std::vector<StoredRun> runs);

}  // namespace stillpoint::bench
