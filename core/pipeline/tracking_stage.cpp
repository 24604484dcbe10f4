// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/tracking_stage.h"

#include <utility>

namespace stillpoint {

TrackingStage::TrackingStage(const OdometryConfig& config, const Rig& rig)
    : predicts_(config.frontend.prediction != TrackerPrediction::kNone),
      tracker_(config.frontend, rig.camera),
      imu_(config.imu.max_gap_s) {}

TrackedFrame TrackingStage::process(const Frame& frame, bool full, const Feedback& feedback,
                                    TrackedFrame memory) {
  const MotionKnowledge& known = feedback.motion;
  MotionPrior prior;
  if (predicts_ && last_frame_) prior = motion_prior(known, imu_, *last_frame_, frame.t);
  forget_spent(known, imu_);
  last_frame_ = frame.t;
  return tracker_.track(frame, prior, full, feedback.moving, std::move(memory));
}

}  // namespace stillpoint
