// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/odometry.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/pipeline/frame_order.h"
#include "core/pipeline/imu_queue.h"
#include "core/pipeline/loop_worker.h"
#include "core/pipeline/stages/optimization_stage.h"
#include "core/pipeline/stages/stage_messages.h"
#include "core/pipeline/stages/tracking_stage.h"
#include "core/pipeline/state_predictor.h"
#include "core/pipeline/window_rate.h"

namespace stillpoint {

struct Odometry::Impl {
  Impl(const OdometryConfig& configuration, const Rig& calibration)
      : config(configuration),
        rig(calibration),
        rate(config.backend.rate_hz),
        tracking(config, rig),
        optimization(config, rig),
        predictor(config.imu.max_gap_s),
        ring(static_cast<std::size_t>(config.pipeline.feedback_lag) + 1, {optimization.feedback(), {}}) {
    if (config.loop.enabled) loop = std::make_unique<LoopWorker>(config, rig, LoopExecution::kInline);
  }

  /// The later one of the estimates that the tracker, whose feedback lags behind, and the optimization use.
  [[nodiscard]] double time_offset() const {
    return std::max(ring[oldest].feedback.motion.time_offset_s, ring[newest].feedback.motion.time_offset_s);
  }

  /// Each stage gets the samples up to the exposure by its own estimate, as on threads.
  void feed_imu(Timestamp t) {
    imu_of_tracker.feed_until(imu_end_of(t, ring[oldest].feedback.motion.time_offset_s),
                              [this](const ImuSample& sample) { tracking.add_imu(sample); });
    imu_of_estimator.feed_until(imu_end_of(t, ring[newest].feedback.motion.time_offset_s),
                                [this](const ImuSample& sample) { optimization.add_imu(sample); });
  }

  OdometryUpdate& track(const Frame& frame, const DetectionSet& detections) {
    order.check(frame.t);
    feed_imu(frame.t);
    const bool enters_window = rate.is_due(frame.t);
    auto& [feedback, tracked] = ring[oldest];
    tracked = tracking.process(frame, enters_window, feedback, std::move(tracked));
    order.accept(frame.t);
    if (enters_window) rate.accept(frame.t);
    OdometryUpdate& update =
        enters_window ? optimization.process(tracked, detections) : optimization.predict(tracked);
    update.timings.add(tracked.timings);
    if (loop) loop->correct(optimization, update);
    feedback = optimization.feedback(std::move(feedback));
    predictor.set(feedback.motion, update.status);
    newest = std::exchange(oldest, (oldest + 1) % ring.size());
    return update;
  }

  OdometryConfig config;
  Rig rig;
  WindowRate rate;
  TrackingStage tracking;
  OptimizationStage optimization;
  std::unique_ptr<LoopWorker> loop;  ///< null if off
  StatePredictor predictor;
  ImuQueue imu_of_tracker, imu_of_estimator;
  FrameOrder order;
  std::vector<TrackerFeedback> ring;  ///< ring buffer of `feedback_lag + 1` messages
  std::size_t oldest = 0;             ///< index in `ring` of the feedback for the next frame
  std::size_t newest = 0;             ///< index in `ring` of the newest frame
};

Odometry::Odometry(const OdometryConfig& config, const Rig& rig)
    : impl_(std::make_unique<Impl>(config, rig)) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&& other) noexcept = default;
Odometry& Odometry::operator=(Odometry&& other) noexcept = default;

void Odometry::add_imu(const ImuSample& sample) {
  impl_->imu_of_tracker.add(sample);
  impl_->imu_of_estimator.add(sample);
  impl_->predictor.add_imu(sample);
}

Timestamp Odometry::needs_imu_until(Timestamp t) const {
  return needed_imu(t, impl_->config, impl_->time_offset());
}

bool Odometry::enters_window(Timestamp t) const { return impl_->rate.is_due(t); }

OdometryUpdate& Odometry::track(const Frame& frame, const DetectionSet& detections) {
  return impl_->track(frame, detections);
}

std::optional<NavState> Odometry::state() const { return impl_->predictor.state(); }

std::optional<NavState> Odometry::state_at(Timestamp t) const { return impl_->predictor.state_at(t); }

const TrackedFrame& Odometry::tracked() const { return impl_->ring[impl_->newest].recycled_frame; }

const DynamicReport& Odometry::dynamic() const { return impl_->optimization.dynamic(); }

const ImuHealth& Odometry::imu_health() const { return impl_->optimization.imu_health(); }

void Odometry::use_map(const KeyframeMap& map) { stillpoint::use_map(impl_->loop.get(), map); }

std::optional<LoopReport> Odometry::finish_loops() {
  return stillpoint::finish_loops(impl_->loop.get(), impl_->optimization);
}

}  // namespace stillpoint
