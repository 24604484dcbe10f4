// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/tracking_stage.h"

#include <algorithm>
#include <utility>

namespace stillpoint {
namespace {

/// Whether a camera delivered the same image again: noise makes two exposures differ.
bool is_repeated(const cv::Mat& before, const cv::Mat& now) {
  if (before.size() != now.size() || before.empty()) return false;
  for (int row = 0; row < now.rows; ++row) {
    if (!std::equal(now.ptr(row), now.ptr(row) + now.cols, before.ptr(row))) return false;
  }
  return true;
}

/// Without features.
TrackedFrame empty_frame(const Frame& frame, TrackedFrame recycled) {
  recycled.id = frame.id;
  recycled.t = frame.t;
  recycled.features.clear();
  recycled.depth = frame.depth;
  recycled.depth_units_per_m = frame.depth_units_per_m;
  recycled.lost = recycled.detected = 0;
  recycled.timings.clear();
  return recycled;
}

/// The motion `first`, and then `second`.
MotionPrior composed(const MotionPrior& first, const MotionPrior& second) {
  return {.T_ccur_cprev = second.T_ccur_cprev * first.T_ccur_cprev,
          .has_rotation = first.has_rotation && second.has_rotation,
          .has_translation = first.has_translation && second.has_translation};
}

}  // namespace

TrackingStage::TrackingStage(const OdometryConfig& config, const Rig& rig)
    : uses_prediction_(config.frontend.prediction != TrackerPrediction::kNone),
      keeps_image_(config.loop.enabled),
      perturbation_(config.pipeline.perturbation_seed, rig.camera.focal_px()),
      tracker_(config.frontend, rig.camera),
      imu_(config.imu.max_gap_s) {}

/// The predicted motion since the image that the tracker knows.
MotionPrior TrackingStage::prior_since_tracked(const MotionState& motion, Timestamp t) {
  MotionPrior prior;
  if (uses_prediction_ && last_frame_) prior = motion_prior(motion, imu_, *last_frame_, t);
  drop_old_samples(motion, imu_);
  last_frame_ = t;
  return since_tracked_ ? composed(*since_tracked_, prior) : prior;
}

TrackedFrame TrackingStage::process(const Frame& frame, bool enters_window, const Feedback& feedback,
                                    TrackedFrame recycled) {
  const MotionPrior prior = prior_since_tracked(feedback.motion, frame.t);
  const bool repeated = is_repeated(last_gray_, frame.gray);
  last_gray_ = frame.gray;
  since_tracked_ = repeated ? std::optional(prior) : std::nullopt;
  const TrackingOptions options{.detect = enters_window, .dynamic_ids = feedback.dynamic_ids};
  TrackedFrame tracked = repeated ? empty_frame(frame, std::move(recycled))
                                  : tracker_.track(frame, prior, options, std::move(recycled));
  tracked.repeated = repeated;
  perturbation_.perturb(tracked);
  if (keeps_image_) tracked.gray = frame.gray;
  return tracked;
}

}  // namespace stillpoint
