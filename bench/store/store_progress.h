// SPDX-License-Identifier: BSD-3-Clause
/// Follows a store while workers execute plans into it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/store/database.h"
#include "bench/store/store.h"

namespace stillpoint::bench {

/// Progress of a plan. Rate and remaining time are those of its live workers on this machine; nullopt without
/// any, and before the first of their runs has ended.
struct PlanProgress {
  std::string name;
  std::string title;
  std::int64_t runs = 0;     ///< of the plan, including those whose sequence is not available
  std::int64_t ended = 0;    ///< with any outcome
  std::int64_t failed = 0;   ///< of them, with another outcome than ok
  bool is_executed = false;  ///< a live worker executes a run of it, or has executed one
  std::optional<double> runs_per_s{};
  std::optional<double> remaining_s{};
};

/// A run that a live worker executes.
struct RunningRun {
  RunIdentity identity;
  double running_s = 0.0;  ///< since its start
};

struct StoreProgress {
  std::size_t workers = 0;          ///< alive, on this machine
  std::int64_t ended = 0;           ///< runs of the store
  std::vector<PlanProgress> plans;  ///< executed ones first
  std::vector<RunningRun> running;
  std::vector<StoredRun> newest;  ///< ended last, the newest first; with metrics
};

/// Reads the progress of one store repeatedly.
class ProgressReader {
 public:
  /// @throws InputError as `Store`
  explicit ProgressReader(const std::filesystem::path& file);

  /// Whether the file was removed or replaced by another one since the constructor: what is read no longer
  /// changes then.
  [[nodiscard]] bool is_replaced() const;

  /// Whether the store was written since the last call; true at the first one.
  [[nodiscard]] bool has_changed();

  /// @param now        present time; rates are relative to it
  /// @param max_newest limit of `StoreProgress::newest`
  [[nodiscard]] StoreProgress read(std::chrono::system_clock::time_point now, std::size_t max_newest) const;

  [[nodiscard]] const Store& store() const { return store_; }

 private:
  Store store_;
  Database database_;
  std::pair<std::uint64_t, std::uint64_t> file_;  ///< device and inode
  std::int64_t version_ = -1;                     ///< of the content, see PRAGMA data_version
};

}  // namespace stillpoint::bench
