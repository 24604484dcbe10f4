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

}  // namespace

TrackingStage::TrackingStage(const OdometryConfig& config, const Rig& rig)
    : uses_prediction_(config.frontend.prediction != TrackerPrediction::kNone),
      keeps_image_(config.loop.enabled),
      perturbation_(config.pipeline.perturbation_seed, rig.camera.focal_px()),
      tracker_(config.frontend, rig.camera),
      imu_(config.imu.max_gap_s) {}

TrackedFrame TrackingStage::process(const Frame& frame, bool enters_window, const Feedback& feedback,
                                    TrackedFrame recycled) {
  const MotionState& motion = feedback.motion;
  MotionPrior prior;
  if (uses_prediction_ && last_frame_) prior = motion_prior(motion, imu_, *last_frame_, frame.t);
  drop_old_samples(motion, imu_);
  dynamic_ids_ = recognition_.tracker_ids(feedback.dynamic_ids, std::move(dynamic_ids_));
  const TrackingOptions options{.detect = enters_window, .dynamic_ids = dynamic_ids_};
  TrackedFrame tracked =
      recognition_.process(frame.gray, tracker_.track(frame, prior, options, std::move(recycled)));
  perturbation_.perturb(tracked);
  if (is_repeated(last_gray_, frame.gray)) tracked.features.clear();
  if (keeps_image_) tracked.gray = frame.gray;
  last_gray_ = frame.gray;
  last_frame_ = frame.t;
  return tracked;
}

}  // namespace stillpoint
