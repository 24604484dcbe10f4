// SPDX-License-Identifier: BSD-3-Clause
/// Which pictures enter the window; the others get a predicted pose.
#pragma once

#include <optional>

#include "core/base/timestamp.h"

namespace stillpoint {

class WindowRate {
 public:
  /// @param rate_hz 0 = every picture
  explicit WindowRate(double rate_hz) : rate_hz_(rate_hz) {}

  /// Whether the picture is due; pictures come in order.
  [[nodiscard]] bool admits(Timestamp t) {
    const bool due = rate_hz_ <= 0.0 || !last_ || seconds_between(*last_, t) >= 1.0 / rate_hz_ - kSlack_s;
    if (due) last_ = t;
    return due;
  }

 private:
  /// A picture this much early still counts as due: cameras jitter, and 30 Hz is no multiple of 10 Hz in
  /// nanoseconds.
  static constexpr double kSlack_s = 0.005;

  double rate_hz_;
  std::optional<Timestamp> last_;
};

}  // namespace stillpoint
