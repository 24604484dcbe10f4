// SPDX-License-Identifier: BSD-3-Clause
/// The frames of a sequence in the order in which they arrive, without those that arrive too late.
#pragma once

#include <optional>
#include <vector>

#include "core/pipeline/runners/runner.h"

namespace stillpoint {

/// Frames enter the odometry in temporal order: an arrival after that of a later frame, or for the second
/// time, is ignored.
class ArrivalOrder {
 public:
  /// Each frame arrives at its timestamp, unless the input has arrivals.
  /// @throws InputError if they are not in temporal order, or one precedes the timestamp of its frame
  explicit ArrivalOrder(const SensorInput& input);

  /// Number of frames that enter.
  [[nodiscard]] std::size_t count() const { return entering_.size(); }
  /// The frames that enter, by ascending index.
  [[nodiscard]] const FrameArrival& operator[](std::size_t i) const { return entering_[i]; }
  /// The frames that do not enter.
  [[nodiscard]] const std::vector<SkippedFrame>& skipped() const { return skipped_; }

 private:
  std::vector<FrameArrival> entering_;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace stillpoint
