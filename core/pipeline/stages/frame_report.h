// SPDX-License-Identifier: BSD-3-Clause
/// Inputs and results of one frame, as passed to the callbacks of the odometry.
#pragma once

#include <functional>
#include <vector>

#include "core/dynamic/semantic_mask.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/odometry_update.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Result of dynamic feature recognition for the newest frame.
struct DynamicReport {
  std::vector<TrackedBox> boxes;     ///< detected and predicted; without margin
  SemanticMask mask;                 ///< the boxes with margin and depth thresholds
  std::vector<DynamicLabel> labels;  ///< of all features, by ascending id

  void clear() {
    boxes.clear();
    mask.clear();
    labels.clear();
  }
};

/// Valid during the call that it is passed to.
struct FrameReport {
  const Frame& frame;
  const TrackedFrame& tracked;
  const DynamicReport& dynamic;  ///< empty for a frame that does not enter the window
  const OdometryUpdate& update;
  /// Time on the IMU clock from which the update is available. In sequential and pipelined execution: when
  /// the last sample that the frame waits for has arrived; in paced modes: when it was computed.
  Timestamp available{};
};

/// Called for each frame, one after the other. The callbacks are invoked in the order of the frames.
using FrameCallbacks = std::vector<std::function<void(const FrameReport&)>>;

inline void notify(const FrameCallbacks& callbacks, const FrameReport& report) {
  for (const auto& callback : callbacks) callback(report);
}

}  // namespace stillpoint
