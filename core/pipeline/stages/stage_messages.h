// SPDX-License-Identifier: BSD-3-Clause
/// Messages between the stages: feedback, frames and detections. Paper Sec. II.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/backend/state_prediction.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Feedback from the optimization stage to the tracking stage.
struct Feedback {
  MotionState motion;                     ///< for the motion prediction of the tracker
  std::vector<std::int64_t> dynamic_ids;  ///< features currently labeled dynamic, ascending
};

/// From optimization to tracking.
struct TrackerFeedback {
  Feedback feedback;
  TrackedFrame recycled_frame;  ///< a processed frame, whose memory the tracker reuses
};

/// From tracking to optimization: a frame with its intermediate results.
struct FrameJob {
  Frame frame;
  std::optional<ModuleSpan> decoding;  ///< time of image decoding, if known
  bool enters_window = false;
  Feedback feedback;     ///< input of the tracker; goes back to the optimization stage for reuse
  TrackedFrame tracked;  ///< result of the tracking stage
};

/// From detection to optimization: the detections of a frame, and the time the detector took.
struct DetectionJob {
  DetectionSet set;
  std::optional<ModuleSpan> timing;  ///< nullopt if no detection finished in time
};

/// Time from `start` to now.
[[nodiscard]] inline ModuleSpan span_since(std::chrono::steady_clock::time_point start, Module module) {
  return {.module = module, .start = start, .elapsed = std::chrono::steady_clock::now() - start};
}

}  // namespace stillpoint
