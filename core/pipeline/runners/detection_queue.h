// SPDX-License-Identifier: BSD-3-Clause
/// Thread-safe queue of detections in order of time, from the detection thread to the optimization thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "core/pipeline/runners/runner_parts.h"

namespace stillpoint {

class DetectionQueue {
 public:
  void put(DetectionJob job) {
    const std::scoped_lock lock(mutex_);
    const auto later =
        std::ranges::find_if(jobs_, [&](const DetectionJob& other) { return other.set.t > job.set.t; });
    jobs_.insert(later, std::move(job));
    changed_.notify_one();
  }

  /// Detections for the frame at time `t`. Waits up to `wait` for those of the frame itself; after a timeout
  /// returns the newest ones of an earlier frame that are at most `max_age_s` older and were not taken
  /// before, else an empty set with state `kLate`. Detections of later frames stay in the queue, earlier ones
  /// are discarded.
  [[nodiscard]] DetectionJob take(Timestamp t, std::chrono::nanoseconds wait, double max_age_s) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [&] { return !jobs_.empty() && jobs_.back().set.t >= t; });
    DetectionJob newest{.set = {.t = t, .state = DetectionState::kLate, .detections = {}}, .timing = {}};
    for (; !jobs_.empty() && jobs_.front().set.t <= t; jobs_.pop_front()) {
      if (seconds_between(jobs_.front().set.t, t) <= max_age_s) newest = std::move(jobs_.front());
    }
    return newest;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<DetectionJob> jobs_;  ///< guarded by mutex_; in order of time
};

}  // namespace stillpoint
