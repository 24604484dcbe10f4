// SPDX-License-Identifier: BSD-3-Clause
/// The optimisation thread's share of a picture: which features move, and where the camera is. Paper Sec. II,
/// III-C to III-E.
#pragma once

#include <vector>

#include "core/backend/estimator.h"
#include "core/dynamic/feature_recognition.h"
#include "core/dynamic/missed_detection.h"
#include "core/dynamic/resting_features.h"
#include "core/pipeline/feedback.h"
#include "core/pipeline/odometry_config.h"

namespace stillpoint {

/// What the recognition of dynamic features made of the newest picture.
struct DynamicReport {
  std::vector<TrackedBox> boxes;         ///< detected and carried; without margin
  SemanticMask mask;                     ///< the boxes with their margin and depth thresholds
  std::vector<FeatureVerdict> verdicts;  ///< of all features, by rising id

  void clear() {
    boxes.clear();
    mask.clear();
    verdicts.clear();
  }
};

/// Joins the estimator with the recognition of dynamic features. Knows nothing of threads.
class OptimizationStage {
 public:
  /// @throws InputError if the rig lacks what the configuration asks for
  OptimizationStage(const OdometryConfig& config, const Rig& rig);

  /// Samples in order of time; those up to a picture's exposure come before the picture.
  void add_imu(const ImuSample& sample) { estimator_.add_imu(sample); }

  /// Takes a picture into the window.
  /// @param detections of the picture; passed over where the mask is off
  /// @return valid until the next picture; who takes part in it may add to it
  [[nodiscard]] OdometryUpdate& process(const TrackedFrame& frame, const DetectionSet& detections);

  /// The pose at a picture that does not enter the window. @return as `process`
  [[nodiscard]] OdometryUpdate& predict(const TrackedFrame& frame);

  [[nodiscard]] MotionKnowledge knowledge() const { return estimator_.knowledge(); }
  /// @param memory for the result: what nobody needs any more
  [[nodiscard]] Feedback feedback(Feedback memory = {}) const;
  [[nodiscard]] const ImuHealth& imu_health() const { return estimator_.imu_health(); }
  [[nodiscard]] const DynamicReport& dynamic() const { return dynamic_; }

 private:
  void begin_update();
  void look_for_objects(const TrackedFrame& frame, const DetectionSet& detections, ModuleTimings& timings);
  void look_for_motion_before(ModuleTimings& timings);
  void look_for_motion_after(ModuleTimings& timings);
  [[nodiscard]] const ConsistencyView& look();
  void take(const std::vector<FeatureVerdict>& verdicts);
  void forget();

  DynamicConfig config_;
  double pixel_sigma_px_;
  Camera camera_;
  Estimator estimator_;
  MissedDetectionCompensation objects_;
  FeatureRecognition recognition_;
  RestingFeatures resting_;
  DynamicReport dynamic_;
  std::vector<std::int64_t> moving_;  ///< of the last picture in the window
  OdometryUpdate update_;             ///< of the last picture
  // Kept for their memory.
  std::vector<Box> boxes_;
  ConsistencyView view_;
  std::vector<ConsistencyResidual> residuals_;
};

}  // namespace stillpoint
