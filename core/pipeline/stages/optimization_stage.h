// SPDX-License-Identifier: BSD-3-Clause
/// Optimization stage: dynamic feature recognition and state estimation for one frame. Paper Sec. II and
/// III-C to III-E.
#pragma once

#include <vector>

#include "core/backend/estimator.h"
#include "core/config/odometry_config.h"
#include "core/dynamic/feature_recognition.h"
#include "core/dynamic/missed_detection.h"
#include "core/dynamic/moving_consistency.h"
#include "core/pipeline/stages/frame_report.h"
#include "core/pipeline/stages/keyframe_collector.h"
#include "core/pipeline/stages/replication.h"
#include "core/pipeline/stages/stage_messages.h"

namespace stillpoint {

/// Combines the estimator with dynamic feature recognition. Single-threaded; the runners provide the threads.
class OptimizationStage final : private DynamicLabeler {
 public:
  /// @throws InputError if the rig lacks a sensor that the configuration requires
  OptimizationStage(const OdometryConfig& config, const Rig& rig);

  /// Samples in temporal order; samples up to the exposure of a frame must be added before the frame.
  void add_imu(const ImuSample& sample) { estimator_.add_imu(perturbation_.of(sample)); }

  /// Processes a frame that enters the window.
  /// @param detections of the frame; ignored if the mask is off
  /// @return valid until the next frame; the caller may add timings to it
  [[nodiscard]] OdometryUpdate& process(const TrackedFrame& frame, const DetectionSet& detections);

  /// Predicts the pose of a frame that does not enter the window. @return as `process`
  [[nodiscard]] OdometryUpdate& predict(const TrackedFrame& frame);

  [[nodiscard]] MotionState motion_state() const { return estimator_.motion_state(); }
  /// Feedback to the tracking stage.
  /// @param recycled a result that is no longer needed; its memory is reused
  [[nodiscard]] Feedback feedback(Feedback recycled = {}) const;
  [[nodiscard]] const ImuHealth& imu_health() const { return estimator_.imu_health(); }
  [[nodiscard]] const DynamicReport& dynamic() const { return dynamic_; }

  /// The keyframe that left the window with the last frame, if loop closure is on, see `KeyframeCollector`.
  [[nodiscard]] std::optional<DepartedKeyframe> take_keyframe();
  /// At the end of a run: the next keyframe that is still in the window.
  [[nodiscard]] std::optional<DepartedKeyframe> take_remaining_keyframe();
  /// Frame `frame`, if it is the newest one, entered the window and is located, see `KeyframeCollector`.
  [[nodiscard]] std::optional<DepartedKeyframe> current_frame(std::int64_t frame);
  /// Returns a keyframe whose memory is reused.
  void recycle(DepartedKeyframe keyframe);

 private:
  // What the estimator asks for in `process`.
  [[nodiscard]] Labels labels_by_detections(const TrackedFrame& frame) override;
  [[nodiscard]] bool uses_prediction() const override {
    return config_.moving_consistency && config_.gate_before_solve;
  }
  [[nodiscard]] Labels labels_at_prediction(const Window& window,
                                            const std::optional<UncertainPose>& camera) override;
  [[nodiscard]] Labels labels_after_refinement(const RefinedWindow& refined) override;

  [[nodiscard]] Labels check_motion(const Window& window);
  void update_view(const Window& window);
  void reset_recognition();

  DynamicConfig config_;
  double feature_sigma_px_;
  Camera camera_;
  InputPerturbation perturbation_;
  Estimator estimator_;
  MissedDetectionCompensation box_tracker_;
  FeatureRecognition recognition_;
  StaticReadmission static_readmission_;
  DynamicReport dynamic_;
  const DetectionSet* detections_ = nullptr;    ///< of the frame that is processed
  std::vector<std::int64_t> dynamic_ids_;       ///< of the last frame that entered the window
  std::optional<Timestamp> last_frame_;         ///< same
  std::optional<KeyframeCollector> keyframes_;  ///< if loop closure is on
  // Members only to reuse the memory.
  std::vector<Box> boxes_;
  ConsistencyView view_;
  std::vector<ConsistencyResidual> residuals_;
};

}  // namespace stillpoint
