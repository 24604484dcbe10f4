// SPDX-License-Identifier: BSD-3-Clause
/// Tracking stage: feature prediction, tracking and detection for one frame. Paper Sec. II, III-A, III-B.
#pragma once

#include <optional>

#include "core/config/odometry_config.h"
#include "core/frontend/feature_tracker.h"
#include "core/pipeline/stages/replication.h"
#include "core/pipeline/stages/stage_messages.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// Predicts feature positions from IMU data and tracks the features. Single-threaded: the runners pass the
/// feedback of the optimization stage as an argument.
class TrackingStage {
 public:
  TrackingStage(const OdometryConfig& config, const Rig& rig);

  /// Samples in temporal order; samples up to the exposure of a frame must be added before the frame.
  void add_imu(const ImuSample& sample) { imu_.add(perturbation_.of(sample)); }

  /// An image that is bit-equal to the previous one is no new observation: it has no features, and the next
  /// image is compared with the one before the repetition.
  /// @param enters_window whether the frame enters the window; if so, lost features are replaced by new ones
  /// @param feedback      newest available feedback of the optimization stage
  /// @param recycled      a result that is no longer needed; its memory is reused
  [[nodiscard]] TrackedFrame process(const Frame& frame, bool enters_window, const Feedback& feedback,
                                     TrackedFrame recycled = {});

 private:
  [[nodiscard]] MotionPrior prior_since_tracked(const MotionState& motion, Timestamp t);

  bool uses_prediction_;
  bool keeps_image_;  ///< for loop closure
  InputPerturbation perturbation_;
  FeatureTracker tracker_;
  ImuBuffer imu_;
  std::optional<Timestamp> last_frame_;
  std::optional<MotionPrior> since_tracked_;  ///< from the last tracked image to the last, repeated one
  cv::Mat last_gray_;
};

}  // namespace stillpoint
