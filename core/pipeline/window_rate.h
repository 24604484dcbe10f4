// SPDX-License-Identifier: BSD-3-Clause
/// Selects the frames that enter the window; the other frames get a predicted pose.
#pragma once

#include <optional>

#include "core/base/timestamp.h"

namespace stillpoint {

class WindowRate {
 public:
  /// @param rate_hz maximum rate of the window; 0 = every frame
  explicit WindowRate(double rate_hz) : rate_hz_(rate_hz) {}

  /// Whether a frame at `t` would enter the window, if it was the next one.
  [[nodiscard]] bool is_due(Timestamp t) const {
    return rate_hz_ <= 0.0 || !last_ || seconds_between(*last_, t) >= 1.0 / rate_hz_ - kSlack_s;
  }

  /// Records that the frame at `t` enters the window.
  void accept(Timestamp t) { last_ = t; }

  /// Whether the frame enters the window; call once per frame, in temporal order.
  [[nodiscard]] bool admits(Timestamp t) {
    const bool due = is_due(t);
    if (due) accept(t);
    return due;
  }

 private:
  /// Tolerance of the interval, for timestamp jitter and because three intervals of 30 Hz, rounded to
  /// nanoseconds, are shorter than 0.1 s.
  static constexpr double kSlack_s = 0.005;

  double rate_hz_;
  std::optional<Timestamp> last_;
};

}  // namespace stillpoint
