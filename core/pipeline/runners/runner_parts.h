// SPDX-License-Identifier: BSD-3-Clause
/// Code shared by the runners: IMU feed, frame loading, detection, and the last steps of a frame.
#pragma once

#include <optional>
#include <span>

#include "core/pipeline/imu_queue.h"
#include "core/pipeline/runners/arrival_order.h"
#include "core/pipeline/runners/runner.h"
#include "core/pipeline/stages/stage_messages.h"

namespace stillpoint {

/// Capacity of the queue before the tracker in paced modes; the oldest frame is dropped when it is full.
constexpr std::size_t kMaxQueuedFrames = 2;

/// Time that the optimization waits for detections in paced modes, as a fraction of the frame interval.
constexpr double kDetectionWaitFraction = 0.3;

/// Median interval between successive frames; 0 for fewer than two frames.
[[nodiscard]] double median_interval_s(std::span<const Timestamp> times);

/// Feeds the IMU samples of a sequence to a stage or an odometry.
class ImuFeed {
 public:
  explicit ImuFeed(std::span<const ImuSample> samples) : samples_(samples) {}

  template <class Stage>
  void feed_until(Timestamp end, Stage& stage) {
    for (; next_ < samples_.size() && samples_[next_].t <= end; ++next_) stage.add_imu(samples_[next_]);
  }

  /// Feeds samples until one at or after `end`. @return false once all samples have been fed
  template <class Odometry>
  bool feed_through(Timestamp end, Odometry& odometry) {
    while (next_ < samples_.size()) {
      const ImuSample& sample = samples_[next_++];
      odometry.add_imu(sample);
      if (sample.t >= end) return true;
    }
    return false;
  }

 private:
  std::span<const ImuSample> samples_;
  std::size_t next_ = 0;
};

/// A loaded frame, or the reason why it could not be read.
struct LoadedFrame {
  std::optional<FrameJob> job;
  std::string error;  ///< if there is no `job`
};
[[nodiscard]] LoadedFrame load_frame(const SensorInput& input, std::size_t index);

/// Loads the frames of a sequence one after the other, and skips those that cannot be read.
class FrameLoader {
 public:
  /// @param input, control must outlive this object
  /// @throws InputError as `ArrivalOrder`
  FrameLoader(const SensorInput& input, const RunControl& control)
      : input_(input), control_(control), order_(input) {
    summary_.skipped = order_.skipped();
  }

  /// @return nullopt at the end of the sequence and after `stop_requested`
  [[nodiscard]] std::optional<FrameJob> next();

  /// Contains `frames`, `skipped` and `interrupted`.
  [[nodiscard]] const RunSummary& summary() const { return summary_; }

 private:
  const SensorInput& input_;
  const RunControl& control_;
  ArrivalOrder order_;
  std::size_t next_ = 0;  ///< in `order_`
  RunSummary summary_;
};

[[nodiscard]] DetectionJob detect_objects(ObjectDetector& detector, const Frame& frame);

/// Calls `on_update` and `on_frame`.
void notify(const RunControl& control, const FrameReport& report);

/// Adds the final state of the IMU and of the detector to the summary.
/// @throws InputError if no frame could be read
[[nodiscard]] RunSummary completed(RunSummary summary, const ImuHealth& imu_health,
                                   const ObjectDetector& detector);

}  // namespace stillpoint
