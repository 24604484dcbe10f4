// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/optimization_stage.h"

#include <span>
#include <utility>

#include "core/pipeline/stages/consistency_view.h"
#include "core/pipeline/stages/replication.h"

namespace stillpoint {
namespace {

using Kind = ScopedTimer::Kind;

/// Largest reprojection error of a feature that stays at one place, px of the focal length: the accuracy of
/// tracking.
constexpr double kStaticResidual_px = 1.0;

std::vector<Box> boxes_of(const std::vector<TrackedBox>& tracked, std::vector<Box> recycled) {
  std::vector<Box> boxes = std::move(recycled);
  boxes.clear();
  for (const TrackedBox& object : tracked) boxes.push_back(object.box);
  return boxes;
}

std::vector<std::int64_t> dynamic_ids(const std::vector<DynamicLabel>& labels,
                                      std::vector<std::int64_t> recycled) {
  std::vector<std::int64_t> ids = std::move(recycled);
  ids.clear();
  for (const DynamicLabel& label : labels) {
    if (label.label != LabelClass::kStable) ids.push_back(label.id);
  }
  return ids;
}

}  // namespace

OptimizationStage::OptimizationStage(const OdometryConfig& config, const Rig& rig)
    : config_(config.dynamic),
      feature_sigma_px_(config.backend.feature_sigma_px),
      camera_(rig.camera),
      perturbation_(config.pipeline.perturbation_seed, rig.camera.focal_px()),
      estimator_(config.backend, config.imu, rig, config.seed),
      box_tracker_(config.dynamic),
      recognition_(config.dynamic),
      static_readmission_(config.dynamic.min_static_frames, kStaticResidual_px) {
  if (config.loop.enabled) keyframes_.emplace(config.loop);
}

OdometryUpdate& OptimizationStage::process(const TrackedFrame& frame, const DetectionSet& detections) {
  if (last_frame_ && frame.t <= *last_frame_) return predict(frame);
  last_frame_ = frame.t;
  dynamic_.clear();
  detections_ = &detections;
  OdometryUpdate& update = estimator_.update();
  {
    const ScopedTimer timer(update.timings, Module::kOptimizationThread);
    estimator_.process(frame, this);
    if (keyframes_) {
      keyframes_->set_located(is_located(update.status), update.segment);
      keyframes_->after_slide(estimator_.window(), frame, dynamic_);
    }
  }
  dynamic_ids_ = dynamic_ids(dynamic_.labels, std::move(dynamic_ids_));
  update.counters.dynamic_features = static_cast<int>(dynamic_ids_.size());
  update.hashes = {.tracking = state_hash(frame.features),
                   .dynamic = state_hash(dynamic_.labels),
                   .optimization = state_hash(update.state)};
  return update;
}

OdometryUpdate& OptimizationStage::predict(const TrackedFrame& frame) {
  dynamic_.clear();
  OdometryUpdate& update = estimator_.predict(frame.id, frame.t);
  update.hashes = {.tracking = state_hash(frame.features), .optimization = state_hash(update.state)};
  return update;
}

Feedback OptimizationStage::feedback(Feedback recycled) const {
  Feedback result = std::move(recycled);
  result.motion = estimator_.motion_state();
  result.dynamic_ids = dynamic_ids_;
  return result;
}

std::optional<DepartedKeyframe> OptimizationStage::take_keyframe() {
  return keyframes_ ? keyframes_->take() : std::nullopt;
}

std::optional<DepartedKeyframe> OptimizationStage::take_remaining_keyframe() {
  return keyframes_ ? keyframes_->take_remaining(estimator_.window()) : std::nullopt;
}

std::optional<DepartedKeyframe> OptimizationStage::current_frame(std::int64_t frame) {
  return keyframes_ ? keyframes_->newest(estimator_.window(), frame) : std::nullopt;
}

void OptimizationStage::recycle(DepartedKeyframe keyframe) {
  if (keyframes_) keyframes_->recycle(std::move(keyframe));
}

/// Sec. III-C and III-D.
DynamicLabeler::Labels OptimizationStage::labels_by_detections(const TrackedFrame& frame) {
  const ScopedTimer timer(estimator_.update().timings, Module::kDynamicRecognition);
  if (config_.mask != DynamicMask::kOff) {
    dynamic_.boxes = box_tracker_.update(*detections_);
    boxes_ = boxes_of(dynamic_.boxes, std::move(boxes_));
    dynamic_.mask.assign(boxes_, {.pixels = frame.depth, .units_per_m = frame.depth_units_per_m},
                         {camera_.width, camera_.height}, config_);
  }
  return dynamic_.labels = recognition_.classify(frame, dynamic_.mask);
}

/// Sec. III-E at the predicted pose.
DynamicLabeler::Labels OptimizationStage::labels_at_prediction(const Window& window,
                                                               const std::optional<UncertainPose>& camera) {
  const ScopedTimer timer(estimator_.update().timings, Module::kDynamicRecognition, Kind::kPart);
  std::optional<PredictionError> error;
  if (config_.gate_probability > 0.0 && camera)
    error = {.camera = *camera, .bearing_sigma = feature_sigma_px_ / camera_.focal_px()};
  update_view(window);
  residuals_ = gate_on_prediction(view_, error, std::move(residuals_));
  return dynamic_.labels = recognition_.gate(residuals_);
}

DynamicLabeler::Labels OptimizationStage::labels_after_refinement(const RefinedWindow& refined) {
  Labels labels;
  if (refined.failed) {
    reset_recognition();
  } else if (config_.moving_consistency) {
    labels = check_motion(refined.window);
  }
  if (keyframes_) keyframes_->before_slide(refined.window, refined.oldest_motion);
  return labels;
}

/// Sec. III-E at the optimized poses.
DynamicLabeler::Labels OptimizationStage::check_motion(const Window& window) {
  const ScopedTimer timer(estimator_.update().timings, Module::kDynamicRecognition, Kind::kPart);
  update_view(window);
  std::span<const std::int64_t> readmitted;
  if (config_.min_static_frames > 0) readmitted = static_readmission_.update(view_);
  residuals_ = consistency_residuals(view_, std::move(residuals_));
  return dynamic_.labels = recognition_.check(residuals_, readmitted);
}

void OptimizationStage::update_view(const Window& window) {
  view_ = consistency_view(window, camera_.focal_px(), feature_sigma_px_, std::move(view_));
}

/// After a tracking failure.
void OptimizationStage::reset_recognition() {
  box_tracker_.reset();
  recognition_.reset();
  static_readmission_.reset();
}

}  // namespace stillpoint
