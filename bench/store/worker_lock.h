// SPDX-License-Identifier: BSD-3-Clause
/// Liveness of worker processes: each holds a file lock (flock), which the kernel releases when it exits.
#pragma once

#include <filesystem>
#include <string>

namespace stillpoint::bench {

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

}  // namespace stillpoint::bench
