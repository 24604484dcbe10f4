// SPDX-License-Identifier: BSD-3-Clause
/// Propagates the first exception of several threads to the thread that joins them.
#pragma once

#include <exception>
#include <mutex>

namespace stillpoint {

class ThreadErrors {
 public:
  /// Runs `work`; stores an exception it throws, and calls `stop`, which must make the other threads finish.
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

  /// Rethrows the stored exception, if any.
  void rethrow() const {
    const std::scoped_lock lock(mutex_);
    if (first_) std::rethrow_exception(first_);
  }

 private:
  mutable std::mutex mutex_;
  std::exception_ptr first_;  ///< guarded by mutex_
};

}  // namespace stillpoint
