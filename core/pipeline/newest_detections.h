// SPDX-License-Identifier: BSD-3-Clause
/// The newest detections, handed from a detector that takes its time to an optimisation that does not wait
/// long.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "core/pipeline/runner_parts.h"

namespace stillpoint {

class NewestDetections {
 public:
  void put(DetectionOnWay found) {
    const std::scoped_lock lock(mutex_);
    newest_ = std::move(found);
    changed_.notify_one();
  }

  /// Boxes for the picture of time `t`: its own, or after waiting for them in vain those of a picture at most
  /// `max_age_s` earlier that were not taken yet; else a late set without boxes.
  [[nodiscard]] DetectionOnWay take(Timestamp t, std::chrono::nanoseconds wait, double max_age_s) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [&] { return newest_ && newest_->set.t >= t; });
    const bool usable = newest_ && seconds_between(newest_->set.t, t) <= max_age_s;
    if (!usable) return {.set = {.t = t, .state = DetectionState::kLate, .detections = {}}, .search = {}};
    DetectionOnWay found = std::move(*newest_);
    newest_.reset();
    return found;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<DetectionOnWay> newest_;  ///< guarded by mutex_; not taken yet
};

}  // namespace stillpoint
