// SPDX-License-Identifier: BSD-3-Clause
/// Which features of a frame are dynamic, as the estimator asks for it while it processes the frame. Paper
/// Sec. III-C to III-E.
#pragma once

#include <optional>
#include <span>

#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// The window after the optimization of a frame and before it slides.
struct RefinedWindow {
  const Window& window;
  bool failed;  ///< the window was cleared and restarts with the next frame
  /// If the oldest frame leaves the window now: its motion to the next frame, with the covariance of the
  /// solve; absent unless that was computed.
  const std::optional<UncertainPose>& oldest_motion;
};

/// Labels at the three moments of a frame at which more is known about it. Landmarks without a label keep
/// theirs. Features are excluded from all that follows once they are labeled dynamic.
class DynamicLabeler {
 public:
  /// Sorted by id; valid until the next call.
  using Labels = std::span<const DynamicLabel>;

  virtual ~DynamicLabeler() = default;

  /// By detected objects and earlier labels.
  /// @param frame that was added to the window
  [[nodiscard]] virtual Labels labels_by_detections(const TrackedFrame& frame) = 0;

  /// Whether labels follow from predicted poses. Inertial data that became wrong abruptly is then recognized
  /// before them.
  [[nodiscard]] virtual bool uses_prediction() const = 0;

  /// By the pose that reliable inertial data predicts; only called if there is one.
  /// @param camera pose of the newest frame, with its covariance relative to the frame before; absent if no
  ///   covariance is known
  [[nodiscard]] virtual Labels labels_at_prediction(const Window& window,
                                                    const std::optional<UncertainPose>& camera) = 0;

  /// By the optimized poses.
  [[nodiscard]] virtual Labels labels_after_refinement(const RefinedWindow& refined) = 0;
};

}  // namespace stillpoint
