// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/odometry.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/pipeline/frame_stepper.h"

namespace stillpoint {

struct Odometry::Impl {
  Impl(const OdometryConfig& configuration, const Rig& rig)
      : config(configuration),
        stepper(config, rig, LoopExecution::kInline),
        ring(static_cast<std::size_t>(config.pipeline.feedback_lag) + 1, {stepper.feedback(), {}}) {}

  OdometryConfig config;
  FrameStepper stepper;
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

void Odometry::add_imu(const ImuSample& sample) { impl_->stepper.add_imu(sample); }

/// By the later one of the estimates that the tracker, whose feedback lags behind, and the optimization use.
Timestamp Odometry::needs_imu_until(Timestamp t) const {
  const double of_tracker = impl_->ring[impl_->oldest].feedback.motion.time_offset_s;
  return needed_imu(t, impl_->config, std::max(of_tracker, impl_->stepper.time_offset_s()));
}

bool Odometry::enters_window(Timestamp t) const { return impl_->stepper.enters_window(t); }

OdometryUpdate& Odometry::track(const Frame& frame, const DetectionSet& detections) {
  auto& [config, stepper, order, ring, oldest, newest] = *impl_;
  order.check(frame.t);
  const bool enters_window = stepper.enters_window(frame.t);
  auto& [feedback, tracked] = ring[oldest];
  tracked = stepper.track(frame, feedback, std::move(tracked));
  order.accept(frame.t);
  OdometryUpdate& update = stepper.optimize(tracked, enters_window ? &detections : nullptr);
  feedback = stepper.feedback(std::move(feedback));
  newest = std::exchange(oldest, (oldest + 1) % ring.size());
  return update;
}

std::optional<NavState> Odometry::state() const { return impl_->stepper.state(); }

std::optional<NavState> Odometry::state_at(Timestamp t) const { return impl_->stepper.state_at(t); }

const TrackedFrame& Odometry::tracked() const { return impl_->ring[impl_->newest].recycled_frame; }

const DynamicReport& Odometry::dynamic() const { return impl_->stepper.dynamic(); }

const ImuHealth& Odometry::imu_health() const { return impl_->stepper.optimization().imu_health(); }

void Odometry::use_map(const KeyframeMap& map) { impl_->stepper.use_map(map); }

std::optional<LoopReport> Odometry::finish_loops() { return impl_->stepper.finish_loops(); }

}  // namespace stillpoint
