// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/odometry.h"

namespace stillpoint {
namespace {

/// A picture this much early still counts as due: cameras jitter, and 30 Hz is no multiple of 10 Hz in
/// nanoseconds.
constexpr double kRateSlack_s = 0.005;

}  // namespace

Odometry::Odometry(const OdometryConfig& config, const Rig& rig)
    : config_(config),
      tracker_(config.frontend, rig.camera),
      estimator_(config.backend, config.imu, rig, config.seed) {}

bool Odometry::enters_window(Timestamp t) const {
  if (config_.backend.rate_hz <= 0.0 || !last_window_frame_) return true;
  return seconds_between(*last_window_frame_, t) >= 1.0 / config_.backend.rate_hz - kRateSlack_s;
}

OdometryUpdate Odometry::process(const Frame& frame) {
  const bool predicts = config_.frontend.prediction != TrackerPrediction::kNone;
  const MotionPrior prior =
      predicts && last_frame_ ? estimator_.motion_prior(*last_frame_, frame.t) : MotionPrior{};
  const bool full = enters_window(frame.t);
  const TrackedFrame tracked = tracker_.track(frame, prior, full);
  last_frame_ = frame.t;
  OdometryUpdate update;
  if (full) {
    last_window_frame_ = frame.t;
    update = estimator_.process(tracked);
  } else {
    update = estimator_.predict(frame.id, frame.t);
  }
  update.timings.add(tracked.timings);
  return update;
}

}  // namespace stillpoint
