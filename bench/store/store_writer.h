// SPDX-License-Identifier: BSD-3-Clause
/// Crash-safe writer of a store: a process that is killed at any time loses at most the runs that it was
/// executing.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/store/blob_files.h"
#include "bench/store/database.h"
#include "bench/store/store.h"

namespace stillpoint::bench {

/// Liveness of worker processes: each holds a file lock (flock), which the kernel releases when it exits.
class WorkerLock {
 public:
  /// Registers this process as a worker, with a folder of its own.
  /// @param folder of all workers of a store; created if it does not exist
  /// @throws InputError if it cannot be written
  explicit WorkerLock(std::filesystem::path folder);
  /// Removes the worker's folder and its content.
  ~WorkerLock();
  WorkerLock(const WorkerLock&) = delete;
  WorkerLock& operator=(const WorkerLock&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::filesystem::path folder() const { return workers_ / name_; }

  /// Whether the worker of that name is alive.
  [[nodiscard]] bool is_alive(const std::string& name) const;

  /// Removes the folders of dead workers.
  void remove_stale() const;

 private:
  std::filesystem::path workers_;
  std::string name_;
  int lock_ = -1;
};

/// A registered worker process that is alive.
struct LiveWorker {
  std::string name;
  std::chrono::system_clock::time_point since;  ///< when it was registered
};

/// The live workers of a store on this machine; may be called by a process that is none.
[[nodiscard]] std::vector<LiveWorker> live_workers(const std::filesystem::path& store_file);

/// Answer to a worker that wants to execute a run.
enum class RunLease {
  kGranted,        ///< to this worker
  kDone,           ///< the run is completed
  kLeasedByOther,  ///< another live worker executes the run
};

/// A worker's connection to a store. Several workers may share a store; no run is executed twice.
class StoreWriter {
 public:
  /// Opens a store, creates or migrates it if necessary, and removes the files of dead workers.
  /// @throws InputError if it cannot be written, is damaged, or was written by a newer version
  explicit StoreWriter(const std::filesystem::path& file);

  /// Stores a plan and the keys of its runs; replaces an earlier plan of that name.
  void record_plan(const StoredPlan& plan);

  /// Leases a run to this worker and marks it as running, unless it is completed or leased by a live worker.
  /// The lease of a dead worker is revoked.
  [[nodiscard]] RunLease acquire(const RunIdentity& identity);

  /// Writes and syncs the attachments of a run, so that `finish` need not wait for the disk. Optional;
  /// thread-safe. @throws InputError if they cannot be written
  void write_files(const RunOutcome& outcome) const;

  /// Completes a leased run. Its files are synced to disk before its row is committed.
  void finish(const RunIdentity& identity, const RunOutcome& outcome);

  /// Returns the lease of a run that was not executed.
  void release(const RunIdentity& identity);

  /// Removes completed runs among `keys` with one of `outcomes`, so that they are executed again.
  void remove_runs(const std::vector<std::string>& keys, const std::vector<Outcome>& outcomes);

  /// Whether a run is completed, with any outcome.
  [[nodiscard]] bool is_done(const std::string& key) const;

  /// A folder for temporary files of a run; removed with this worker.
  [[nodiscard]] std::filesystem::path work_folder(const RunIdentity& identity) const;

  [[nodiscard]] const std::filesystem::path& file() const { return database_.file(); }

 private:
  void write_details(std::int64_t run, const RunOutcome& outcome);

  Database database_;
  BlobFiles blobs_;
  WorkerLock worker_;
};

}  // namespace stillpoint::bench
