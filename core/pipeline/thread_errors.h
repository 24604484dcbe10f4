// SPDX-License-Identifier: BSD-3-Clause
/// Carries the first exception of several threads to the one that waits for them.
#pragma once

#include <exception>
#include <mutex>

namespace stillpoint {

class ThreadErrors {
 public:
  /// Runs `work`; keeps what it throws, and calls `stop` then, which makes the other threads end.
  template <class Work, class Stop>
  void guard(const Work& work, const Stop& stop) noexcept {
    try {
      work();
    } catch (...) {
      {
        const std::scoped_lock lock(mutex_);
        if (!first_) first_ = std::current_exception();
      }
      stop();
    }
  }

  /// Throws what was kept, if anything; all guarded threads are over.
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr first_;  ///< guarded by mutex_
};

}  // namespace stillpoint
