// SPDX-License-Identifier: BSD-3-Clause
/// Transitions between the states of odometry_update.h, and relocalization after a loss by the map of trusted
/// landmarks.
#pragma once

#include <cstdint>
#include <optional>

#include "core/backend/health/trusted_map.h"
#include "core/backend/vision/vision_assessment.h"
#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"
#include "core/types/odometry_update.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// What is known about a frame after its optimization.
struct FrameEvidence {
  Timestamp t;
  int features = 0;        ///< in the frame
  bool bridged = false;    ///< repeated image; constant velocity gives a pose with its covariance
  bool has_start = false;  ///< scale, and with an IMU gravity and velocity, are known
  bool inertial = false;   ///< same for gravity and velocity alone
  bool located = false;    ///< by vision
  VisionAssessment vision;
  Matrix6 covariance = Matrix6::Zero();  ///< of the pose, see UncertainPose; zero = unknown
  StatusReason imu_defect = StatusReason::kNone;
  bool contradiction = false;  ///< inertial data and vision differ; which of them is wrong is not known
  StatusReason failure = StatusReason::kNone;  ///< the window was cleared because of it
};

struct MonitorOptions {
  bool uses_imu = true;
  double inlier_threshold = 0.01;  ///< of relocalization [normalized image plane]
  double bearing_sigma = 0.003;    ///< standard deviation of a bearing [normalized image plane]
  double max_dead_reckoning_s = 6.0;
  double max_relocalization_s = 1.0;
  std::uint32_t seed = 1;
};

/// Decides about the status of each frame. The owner clears its window when told so.
class TrackingMonitor {
 public:
  explicit TrackingMonitor(const MonitorOptions& options) : options_(options) {}

  /// Camera pose by the map of trusted landmarks, while dead reckoning or lost. The distance to the
  /// prediction is limited by the time since vision last located the camera and the speed of a camera in the
  /// hand; with a covariance of the prediction, the caller decides by that.
  /// @param T_w_c predicted
  [[nodiscard]] std::optional<UncertainPose> relocalize(const TrackedFrame& frame, const Pose& T_w_c);

  /// The window was restarted at a pose found by `relocalize`.
  void relocated() { relocated_ = true; }

  /// Decides about a frame that entered the window. A window of trusted landmarks updates the map.
  /// @return whether the window must be cleared: dead reckoning ends without vision, or a new segment begins
  [[nodiscard]] bool update(const FrameEvidence& evidence, const Window& window);

  [[nodiscard]] OdometryStatus status() const { return status_; }
  [[nodiscard]] StatusReason reason() const { return reason_; }
  /// Number of the current world frame.
  [[nodiscard]] int segment() const { return segment_; }
  [[nodiscard]] const TrustedMap& map() const { return map_; }
  /// The pose of the window is not in the world of the segment: the map has to confirm it.
  [[nodiscard]] bool awaits_map() const { return awaits_map_; }

 private:
  struct Decision {
    OdometryStatus status;
    StatusReason reason;
  };
  [[nodiscard]] Decision decide(const FrameEvidence& evidence) const;
  [[nodiscard]] bool bridges(const FrameEvidence& evidence) const;
  [[nodiscard]] bool is_too_uncertain(const FrameEvidence& evidence) const;
  [[nodiscard]] Decision decide_located(const FrameEvidence& evidence) const;
  [[nodiscard]] bool patience_is_over(const FrameEvidence& evidence);
  void begin_segment();

  MonitorOptions options_;
  TrustedMap map_;
  OdometryStatus status_ = OdometryStatus::kInitializing;
  StatusReason reason_ = StatusReason::kNone;
  Timestamp located_at_;
  double located_sigma_m_ = 0.0;            ///< at that time
  std::optional<Timestamp> visible_since_;  ///< lost, but with enough features
  int visible_frames_ = 0;                  ///< same, number of frames
  int segment_ = 0;
  bool awaits_map_ = false;
  bool relocated_ = false;  ///< in this frame
};

}  // namespace stillpoint
