// SPDX-License-Identifier: BSD-3-Clause
/// Parts of the paced modes: the clock and the detections of a real-time run, and the cores of a simulated
/// device.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/timestamp.h"
#include "core/pipeline/runners/sequence_feed.h"

namespace stillpoint {

/// Maps the timestamps of a recording to the wall clock.
class PacingClock {
 public:
  /// @param first recorded timestamp that corresponds to the current time
  /// @param speed playback speed, > 0
  PacingClock(Timestamp first, double speed)
      : first_(first), speed_(speed), start_(std::chrono::steady_clock::now()) {}

  /// Sleeps until recorded time `t`; polls `stop_requested` every kMaxSleep_s.
  /// @return false if stopped
  bool wait_until(Timestamp t, const std::function<bool()>& stop_requested) const {
    while (true) {
      if (stop_requested && stop_requested()) return false;
      const std::chrono::duration<double> left(seconds_late(t) / -speed_);
      if (left.count() <= 0.0) return true;
      std::this_thread::sleep_for(std::min(left, std::chrono::duration<double>(kMaxSleep_s)));
    }
  }

  /// Seconds of recorded time since `t`; negative before `t`.
  [[nodiscard]] double seconds_late(Timestamp t) const {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    return elapsed.count() * speed_ - seconds_between(first_, t);
  }

  /// Same in seconds of wall clock time.
  [[nodiscard]] double wall_seconds_late(Timestamp t) const { return seconds_late(t) / speed_; }

 private:
  static constexpr double kMaxSleep_s = 0.1;

  Timestamp first_;
  double speed_;
  std::chrono::steady_clock::time_point start_;
};

/// Thread-safe queue of detections in order of time, from the detection thread to the optimization thread.
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

/// Non-preemptive list scheduling: each job runs on the core that becomes free first, in order of the calls.
class DeviceCores {
 public:
  using Time = std::chrono::nanoseconds;  ///< since the first frame

  /// @param count at least 1
  explicit DeviceCores(int count) : free_at_(static_cast<std::size_t>(count), Time{}) {}

  /// Schedules a job that can start at `ready`. @return its end
  [[nodiscard]] Time occupy(Time ready, Time cost) {
    const auto core = std::ranges::min_element(free_at_);
    *core = std::max(ready, *core) + cost;
    return *core;
  }

 private:
  std::vector<Time> free_at_;
};

}  // namespace stillpoint
