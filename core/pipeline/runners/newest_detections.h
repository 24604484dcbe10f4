// SPDX-License-Identifier: BSD-3-Clause
/// Thread-safe mailbox for the newest detections, from the detection thread to the optimization thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "core/pipeline/runners/runner_parts.h"

namespace stillpoint {

class NewestDetections {
 public:
  void put(DetectionJob job) {
    const std::scoped_lock lock(mutex_);
    newest_ = std::move(job);
    changed_.notify_one();
  }

  /// Detections for the frame at time `t`. Waits up to `wait` for those of the frame itself; after a timeout
  /// returns those of an earlier frame if they are at most `max_age_s` older and were not taken before, else
  /// an empty set with state `kLate`.
  [[nodiscard]] DetectionJob take(Timestamp t, std::chrono::nanoseconds wait, double max_age_s) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [&] { return newest_ && newest_->set.t >= t; });
    const bool usable = newest_ && seconds_between(newest_->set.t, t) <= max_age_s;
    if (!usable) return {.set = {.t = t, .state = DetectionState::kLate, .detections = {}}, .timing = {}};
    DetectionJob job = std::move(*newest_);
    newest_.reset();
    return job;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<DetectionJob> newest_;  ///< guarded by mutex_; empty after `take`
};

}  // namespace stillpoint
