// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/frame_stepper.h"

#include <limits>
#include <utility>

#include "core/base/error.h"

namespace stillpoint {

using Reader = ImuQueue::Reader;

void FrameOrder::check(Timestamp t) const {
  if (last_ && t < *last_) {
    throw InputError("frame at " + std::to_string(t.ns) + " ns", "is earlier than the previous frame (" +
                                                                     std::to_string(last_->ns) +
                                                                     " ns); add frames in temporal order");
  }
}

FrameStepper::FrameStepper(const OdometryConfig& config, const Rig& rig, LoopExecution loop_execution,
                           const ImuLookahead& lookahead)
    : config_(config),
      lookahead_(lookahead),
      rate_(config.backend.rate_hz),
      tracking_(config, rig),
      optimization_(config, rig),
      predictor_(config.imu.max_gap_s) {
  if (config.loop.enabled) loop_ = std::make_unique<LoopWorker>(config, rig, loop_execution);
}

TrackedFrame FrameStepper::track(const Frame& frame, const Feedback& feedback, TrackedFrame recycled) {
  const Timestamp end = after(frame.t, feedback.motion.time_offset_s + lookahead_.tracking_s);
  imu_.read_until(Reader::kTracking, end, [this](const ImuSample& sample) { tracking_.add_imu(sample); });
  const bool due = rate_.is_due(frame.t);
  TrackedFrame tracked = tracking_.process(frame, due, feedback, std::move(recycled));
  if (due) rate_.accept(frame.t);
  return tracked;
}

OdometryUpdate& FrameStepper::optimize(const TrackedFrame& tracked, const DetectionSet* detections) {
  const Timestamp end = after(tracked.t, time_offset_s() + lookahead_.optimization_s);
  imu_.read_until(Reader::kOptimization, end,
                  [this](const ImuSample& sample) { optimization_.add_imu(sample); });
  OdometryUpdate& update =
      detections != nullptr ? optimization_.process(tracked, *detections) : optimization_.predict(tracked);
  update.timings.add(tracked.timings);
  if (loop_) loop_->correct(optimization_, update);
  publish(update);
  return update;
}

OdometryUpdate& FrameStepper::optimize(const FrameJob& job, const std::optional<DetectionJob>& detections) {
  OdometryUpdate& update = optimize(job.tracked, detections ? &detections->set : nullptr);
  if (job.decoding) update.timings.add(*job.decoding, 1);
  if (detections && detections->timing) update.timings.add(*detections->timing, 1);
  return update;
}

void FrameStepper::publish(const OdometryUpdate& update) {
  const std::scoped_lock lock(mutex_);
  read_all_samples();
  predictor_.set(optimization_.motion_state(), update.status);
  imu_health_ = optimization_.imu_health();
}

/// Requires mutex_.
void FrameStepper::read_all_samples() {
  constexpr Timestamp kLast{std::numeric_limits<std::int64_t>::max()};
  imu_.read_until(Reader::kPrediction, kLast,
                  [this](const ImuSample& sample) { predictor_.add_imu(sample); });
}

std::optional<NavState> FrameStepper::state() const {
  const std::scoped_lock lock(mutex_);
  return predictor_.state();
}

std::optional<NavState> FrameStepper::state_at(Timestamp t) {
  const std::scoped_lock lock(mutex_);
  read_all_samples();
  return predictor_.state_at(t);
}

ImuHealth FrameStepper::imu_health() const {
  const std::scoped_lock lock(mutex_);
  return imu_health_;
}

void FrameStepper::use_map(const KeyframeMap& map) {
  if (!loop_) throw InputError("loop.enabled", "is off, but a map requires loop closure; set it to true");
  loop_->use_map(map);
}

std::optional<LoopReport> FrameStepper::finish_loops() {
  if (!loop_) return std::nullopt;
  return loop_->finish(optimization_);
}

}  // namespace stillpoint
