// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/optimization_stage.h"

#include <span>
#include <utility>

#include "core/pipeline/stages/consistency_view.h"
#include "core/pipeline/stages/replication.h"

namespace stillpoint {
namespace {

using Kind = ScopedTimer::Kind;

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
      static_readmission_(config.dynamic.min_static_frames, config.dynamic.static_residual_px) {
  if (config.loop.enabled) keyframes_.emplace(config.loop);
}

OdometryUpdate& OptimizationStage::process(const TrackedFrame& frame, const DetectionSet& detections) {
  if (last_frame_ && frame.t <= *last_frame_) return predict(frame);
  last_frame_ = frame.t;
  dynamic_.clear();
  OdometryUpdate& update = estimator_.update();
  {
    const ScopedTimer timer(update.timings, Module::kOptimizationThread);
    estimator_.add(frame);
    apply_semantic_mask(frame, detections);
    check_motion_before_solve();
    if (estimator_.refine()) {
      check_motion_after_solve();
    } else {
      reset_recognition();
    }
    if (keyframes_) keyframes_->before_slide(estimator_.window(), estimator_.oldest_motion());
    estimator_.finish();
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
  estimator_.predict(frame.id, frame.t);
  OdometryUpdate& update = estimator_.update();
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
void OptimizationStage::apply_semantic_mask(const TrackedFrame& frame, const DetectionSet& detections) {
  const ScopedTimer timer(estimator_.update().timings, Module::kDynamicRecognition);
  if (config_.mask != DynamicMask::kOff) {
    dynamic_.boxes = box_tracker_.update(detections);
    boxes_ = boxes_of(dynamic_.boxes, std::move(boxes_));
    dynamic_.mask.assign(boxes_, {.pixels = frame.depth, .units_per_m = frame.depth_units_per_m},
                         {camera_.width, camera_.height}, config_);
  }
  apply_labels(recognition_.classify(frame, dynamic_.mask));
}

/// Sec. III-E at the predicted pose, which requires inertial data.
void OptimizationStage::check_motion_before_solve() {
  if (!config_.moving_consistency || !config_.gate_before_solve) return;
  estimator_.check_prediction();
  if (!estimator_.has_inertial_prediction()) return;
  const ScopedTimer timer(estimator_.update().timings, Module::kDynamicRecognition, Kind::kPart);
  std::optional<PredictionError> error;
  if (config_.gate_probability > 0.0) {
    if (const std::optional<UncertainPose> camera = estimator_.predicted_camera())
      error = {.camera = *camera, .bearing_sigma = feature_sigma_px_ / camera_.focal_px()};
  }
  residuals_ = gate_on_prediction(update_view(), error, std::move(residuals_));
  apply_labels(recognition_.gate(residuals_));
}

/// Sec. III-E at the optimized poses.
void OptimizationStage::check_motion_after_solve() {
  if (!config_.moving_consistency) return;
  const ScopedTimer timer(estimator_.update().timings, Module::kDynamicRecognition, Kind::kPart);
  const ConsistencyView& view = update_view();
  std::span<const std::int64_t> readmitted;
  if (config_.min_static_frames > 0) readmitted = static_readmission_.update(view);
  residuals_ = consistency_residuals(view, std::move(residuals_));
  apply_labels(recognition_.check(residuals_, readmitted));
}

const ConsistencyView& OptimizationStage::update_view() {
  view_ = consistency_view(estimator_.window(), camera_.focal_px(), feature_sigma_px_, std::move(view_));
  return view_;
}

void OptimizationStage::apply_labels(const std::vector<DynamicLabel>& labels) {
  dynamic_.labels = labels;
  estimator_.mark_dynamic(dynamic_.labels);
}

/// After a tracking failure.
void OptimizationStage::reset_recognition() {
  box_tracker_.reset();
  recognition_.reset();
  static_readmission_.reset();
}

}  // namespace stillpoint
