// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/optimization_stage.h"

#include <span>
#include <utility>

#include "core/pipeline/consistency_view.h"
#include "core/pipeline/state_hash.h"

namespace stillpoint {
namespace {

using Kind = ScopedTimer::Kind;

std::vector<Box> boxes_of(const std::vector<TrackedBox>& tracked, std::vector<Box> memory) {
  std::vector<Box> boxes = std::move(memory);
  boxes.clear();
  for (const TrackedBox& object : tracked) boxes.push_back(object.box);
  return boxes;
}

std::vector<std::int64_t> dynamic_ids(const std::vector<FeatureVerdict>& verdicts,
                                      std::vector<std::int64_t> memory) {
  std::vector<std::int64_t> ids = std::move(memory);
  ids.clear();
  for (const FeatureVerdict& verdict : verdicts) {
    if (verdict.verdict != Verdict::kStable) ids.push_back(verdict.id);
  }
  return ids;
}

}  // namespace

OptimizationStage::OptimizationStage(const OdometryConfig& config, const Rig& rig)
    : config_(config.dynamic),
      pixel_sigma_px_(config.backend.pixel_sigma_px),
      camera_(rig.camera),
      estimator_(config.backend, config.imu, rig, config.seed),
      objects_(config.dynamic),
      recognition_(config.dynamic),
      resting_(config.dynamic.rest_pictures, config.dynamic.rest_px) {}

void OptimizationStage::begin_update() {
  ModuleTimings timings = std::move(update_.timings);
  timings.clear();
  update_ = {.timings = std::move(timings)};
  dynamic_.clear();
}

OdometryUpdate& OptimizationStage::process(const TrackedFrame& frame, const DetectionSet& detections) {
  begin_update();
  {
    const ScopedTimer timer(update_.timings, Module::kOptimizationThread);
    estimator_.add(frame, update_);
    look_for_objects(frame, detections, update_.timings);
    look_for_motion_before(update_.timings);
    if (estimator_.refine(update_)) {
      look_for_motion_after(update_.timings);
    } else {
      forget();
    }
    estimator_.finish(update_);
  }
  moving_ = dynamic_ids(dynamic_.verdicts, std::move(moving_));
  update_.counters.dynamic_features = static_cast<int>(moving_.size());
  update_.hashes = {.tracking = state_hash(frame.features),
                    .dynamic = state_hash(dynamic_.verdicts),
                    .optimization = state_hash(update_.state)};
  return update_;
}

OdometryUpdate& OptimizationStage::predict(const TrackedFrame& frame) {
  begin_update();
  estimator_.predict(frame.id, frame.t, update_);
  update_.hashes = {.tracking = state_hash(frame.features), .optimization = state_hash(update_.state)};
  return update_;
}

Feedback OptimizationStage::feedback(Feedback memory) const {
  Feedback said = std::move(memory);
  said.motion = estimator_.knowledge();
  said.moving = moving_;
  return said;
}

/// Sec. III-C and III-D.
void OptimizationStage::look_for_objects(const TrackedFrame& frame, const DetectionSet& detections,
                                         ModuleTimings& timings) {
  const ScopedTimer timer(timings, Module::kDynamicRecognition);
  if (config_.mask != DynamicMask::kOff) {
    dynamic_.boxes = objects_.update(detections);
    boxes_ = boxes_of(dynamic_.boxes, std::move(boxes_));
    dynamic_.mask.assign(boxes_, {.pixels = frame.depth, .units_per_m = frame.depth_units_per_m},
                         {camera_.width, camera_.height}, config_);
  }
  take(recognition_.judge(frame, dynamic_.mask));
}

/// Sec. III-E at the predicted pose, which only inertial data know before the solve.
void OptimizationStage::look_for_motion_before(ModuleTimings& timings) {
  if (!config_.moving_consistency || !config_.gate_before_solve || !estimator_.window().inertial) return;
  const ScopedTimer timer(timings, Module::kDynamicRecognition, Kind::kPart);
  residuals_ = gate_on_prediction(look(), std::move(residuals_));
  take(recognition_.gate(residuals_));
}

/// Sec. III-E at the refined poses.
void OptimizationStage::look_for_motion_after(ModuleTimings& timings) {
  if (!config_.moving_consistency) return;
  const ScopedTimer timer(timings, Module::kDynamicRecognition, Kind::kPart);
  const ConsistencyView& seen = look();
  std::span<const std::int64_t> resting;
  if (config_.rest_pictures > 0) resting = resting_.update(seen);
  residuals_ = consistency_residuals(seen, std::move(residuals_));
  take(recognition_.check(residuals_, resting));
}

const ConsistencyView& OptimizationStage::look() {
  view_ = consistency_view(estimator_.window(), camera_.focal_px(), pixel_sigma_px_, std::move(view_));
  return view_;
}

void OptimizationStage::take(const std::vector<FeatureVerdict>& verdicts) {
  dynamic_.verdicts = verdicts;
  estimator_.mark_dynamic(dynamic_.verdicts);
}

/// After a failure nothing is known of anything.
void OptimizationStage::forget() {
  objects_.reset();
  recognition_.reset();
  resting_.reset();
}

}  // namespace stillpoint
