// SPDX-License-Identifier: BSD-3-Clause
/// Maintenance of stores: verification, garbage collection, transfer of completed runs, and comparison by
/// content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/store/blob_files.h"
#include "bench/store/store_writer.h"

namespace stillpoint::bench {

/// Adds a completed run unless the store already contains it. @return whether it was added
bool add_run(StoreWriter& writer, const RunIdentity& identity, const RunOutcome& outcome);

/// Faults of a store, one line each; empty if there are none. Reads every file.
/// @throws InputError if it cannot be opened at all
[[nodiscard]] std::vector<std::string> verify_store(const std::filesystem::path& file);

struct GarbageReport {
  std::size_t files = 0;  ///< without a reference from a run
  std::int64_t bytes = 0;
  std::size_t manifests = 0;
};

/// Removes files and manifests that no run references, and the folders of dead workers.
GarbageReport collect_garbage(const std::filesystem::path& file);

struct MergeReport {
  std::size_t added = 0;
  std::size_t present = 0;   ///< already in the target store
  std::size_t restored = 0;  ///< files of these that were missing or damaged there
  /// Those of them that ended there with another outcome or other errors: "run KEY (SEQUENCE VARIANT)".
  std::vector<std::string> contradicting;
};

/// Adds completed runs to a store, which is created if it does not exist. Runs that it already contains are
/// not changed, but compared, apart from what depends on the machine; their missing or damaged files are
/// restored.
class RunMerger {
 public:
  explicit RunMerger(const std::filesystem::path& into);

  void add(const RunIdentity& identity, const RunOutcome& outcome);

  [[nodiscard]] StoreWriter& writer() { return writer_; }
  [[nodiscard]] const MergeReport& report() const { return report_; }

 private:
  using Results = std::map<std::string, std::string>;  ///< text by name
  struct PresentRun {
    Results results;
    std::map<std::string, std::string> files;  ///< names by kind
  };

  void restore_files(const PresentRun& run, const RunOutcome& outcome);

  StoreWriter writer_;
  BlobFiles files_;
  std::map<std::string, PresentRun> present_;  ///< by key of the run
  MergeReport report_;
};

/// Adds the completed runs of `from` to `into`, with their plans, manifests, files and acceptances, see
/// RunMerger.
/// @throws InputError if a file of `from` is missing or damaged; runs added before remain
MergeReport merge_stores(const std::filesystem::path& from, const std::filesystem::path& into);

/// Differences between the completed runs and the plans of two stores, one line each; empty if they are
/// equal, as after execution of the same plan at two places. A run is compared by its identity, outcome,
/// metrics, manifest, timed modules and attachments. Not compared: what depends on the machine or on the time
/// of execution, that is, times, memory and load, the host in the manifest, time stamps, and the attachments
/// "result", "timings", "stacks" and "log".
/// @throws InputError if one of them cannot be read
[[nodiscard]] std::vector<std::string> store_differences(const std::filesystem::path& first,
                                                         const std::filesystem::path& second);

}  // namespace stillpoint::bench
