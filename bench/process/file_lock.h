// SPDX-License-Identifier: BSD-3-Clause
/// A lock on a file (flock), which the kernel releases when the process exits.
#pragma once

#include <filesystem>
#include <functional>

namespace stillpoint::bench {

enum class LockKind {
  kShared,     ///< with other shared locks
  kExclusive,  ///< alone
};

class FileLock {
 public:
  /// Waits until no other process holds a conflicting lock.
  /// @param file           created if it does not exist
  /// @param kind           which locks of others conflict
  /// @param stop_requested polled after each signal; if it returns true, the lock is not taken
  /// @throws InputError if it cannot be opened or locked
  FileLock(const std::filesystem::path& file, LockKind kind,
           const std::function<bool()>& stop_requested = nullptr);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// Whether a process, this one included, holds a lock on a file now.
[[nodiscard]] bool is_locked(const std::filesystem::path& file);

}  // namespace stillpoint::bench
