// SPDX-License-Identifier: BSD-3-Clause
/// Convergence of the time offset between camera and IMU after a start.
#pragma once

#include <optional>
#include <vector>

#include "core/base/timestamp.h"

namespace stillpoint {

/// A time offset that is wrong by dt makes inertial data differ from vision by the angular acceleration times
/// dt, which looks like wrong biases. The covariance does not tell when that has ended: it is that of a
/// linearization, and claims 0.5 ms while an estimate is still 35 ms off. The estimate itself tells, as it
/// moves on. It has settled when it changed by less than 1.5 ms in 0.5 s, at the latest after 3 s, and counts
/// as settled from then on: a sensor that becomes wrong later moves it, too.
class OffsetSettling {
 public:
  /// @param t of a frame, later than the last one
  /// @param offset_s estimate [s]
  /// @return whether the estimate has settled
  bool update(Timestamp t, double offset_s);

  /// After a restart with the time offset of the rig.
  void reset();

 private:
  struct Estimate {
    Timestamp t;
    double offset_s;
  };
  std::vector<Estimate> estimates_;  ///< of the last 0.5 s, and the newest one before
  std::optional<Timestamp> first_;
  bool settled_ = false;
};

}  // namespace stillpoint
