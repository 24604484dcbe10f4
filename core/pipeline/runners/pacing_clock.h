// SPDX-License-Identifier: BSD-3-Clause
/// Maps the timestamps of a recording to the wall clock.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include "core/base/timestamp.h"

namespace stillpoint {

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

}  // namespace stillpoint
