// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/tracking_stage.h"

#include <utility>

namespace stillpoint {
namespace {

/// Samples this long before the newest state are kept: the time offset may still change.
constexpr double kKeptBefore_s = 0.2;

}  // namespace

TrackingStage::TrackingStage(const OdometryConfig& config, const Rig& rig)
    : predicts_(config.frontend.prediction != TrackerPrediction::kNone),
      tracker_(config.frontend, rig.camera),
      imu_(config.imu.max_gap_s) {}

TrackedFrame TrackingStage::process(const Frame& frame, bool full, const Feedback& feedback,
                                    TrackedFrame memory) {
  const MotionKnowledge& known = feedback.motion;
  MotionPrior prior;
  if (predicts_ && last_frame_) prior = motion_prior(known, imu_, *last_frame_, frame.t);
  if (known.begun) imu_.forget_before(after(known.newest.t, known.time_offset_s - kKeptBefore_s));
  last_frame_ = frame.t;
  return tracker_.track(frame, prior, full, feedback.moving, std::move(memory));
}

}  // namespace stillpoint
