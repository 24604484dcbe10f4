// SPDX-License-Identifier: BSD-3-Clause
/// Thread-safe queue of IMU samples in front of a stage, on which the thread of the stage can wait.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>

#include "core/pipeline/imu_queue.h"

namespace stillpoint {

class ImuInbox {
 public:
  void add(const ImuSample& sample) {
    const std::scoped_lock lock(mutex_);
    queue_.add(sample);
    if (!newest_ || sample.t > *newest_) newest_ = sample.t;
    changed_.notify_one();
  }

  /// Announces that no more samples will be added, so that `wait_until` no longer waits.
  void finish() {
    const std::scoped_lock lock(mutex_);
    finished_ = true;
    changed_.notify_one();
  }

  /// Blocks until a sample at or after `t` has been added, or `finish` was called.
  void wait_until(Timestamp t) {
    constexpr Timestamp kNothing{std::numeric_limits<std::int64_t>::min()};
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return finished_ || newest_.value_or(kNothing) >= t; });
  }

  /// As `ImuQueue::feed_until`.
  template <class Sink>
  void feed_until(Timestamp end, const Sink& sink) {
    const std::scoped_lock lock(mutex_);
    queue_.feed_until(end, sink);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  // All guarded by mutex_.
  ImuQueue queue_;
  std::optional<Timestamp> newest_;  ///< latest sample added so far
  bool finished_ = false;
};

}  // namespace stillpoint
