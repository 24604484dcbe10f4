// SPDX-License-Identifier: BSD-3-Clause
/// Writes a store while runs are made, so that whoever is killed at any moment loses at most the run in
/// flight.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/blob_files.h"
#include "bench/store/database.h"
#include "bench/store/driver_lock.h"
#include "bench/store/store.h"
#include "bench/store/stored_run.h"

namespace stillpoint {

enum class Claim {
  kGranted,    ///< the run is ours to make
  kDone,       ///< it has been made
  kElsewhere,  ///< a living driver is making it
};

/// One driver's hold of a store. Several drivers may share one: no run is made twice.
class Journal {
 public:
  /// Opens a store, made or migrated if need be, and clears away what dead drivers left behind.
  /// @throws InputError if it cannot be written, is damaged, or a newer program's
  explicit Journal(const std::filesystem::path& file);

  /// Keeps a plan and the runs it consists of, replacing an earlier plan of that name.
  void record_plan(const StoredPlan& plan);

  /// Enters a run as begun, unless it is done or in living hands. A run that a dead driver began is begun
  /// anew.
  [[nodiscard]] Claim claim(const RunIdentity& identity);

  /// Completes a run that was claimed. Its files are on the disk before its row says so.
  void finish(const RunIdentity& identity, const RunOutcome& outcome);

  /// Gives a claimed run back: it was not made.
  void release(const RunIdentity& identity);

  /// Forgets ended runs of these outcomes among the given, so that they are made again.
  void forget(const std::vector<std::string>& keys, const std::vector<Outcome>& outcomes);

  /// Whether a run has ended, whatever its outcome.
  [[nodiscard]] bool is_done(const std::string& key) const;

  /// A folder for the unfinished files of a run; it vanishes with this driver.
  [[nodiscard]] std::filesystem::path work_folder(const RunIdentity& identity) const;

  [[nodiscard]] const std::filesystem::path& file() const { return database_.file(); }

 private:
  void write_details(std::int64_t run, const RunOutcome& outcome);

  Database database_;
  BlobFiles blobs_;
  DriverLock driver_;
};

}  // namespace stillpoint
