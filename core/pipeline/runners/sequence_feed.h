// SPDX-License-Identifier: BSD-3-Clause
/// Frames, IMU samples and detections of a sequence, as the runners feed them to the odometry.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/pipeline/imu_queue.h"
#include "core/pipeline/runners/runner.h"
#include "core/pipeline/stages/stage_messages.h"

namespace stillpoint {

/// Capacity of the queue before the tracker in paced modes; the oldest frame is dropped when it is full.
constexpr std::size_t kMaxQueuedFrames = 2;

/// Time that the optimization waits for detections in paced modes, as a fraction of the frame interval.
constexpr double kDetectionWaitFraction = 0.3;

/// Median interval between successive frames; 0 for fewer than two frames.
[[nodiscard]] double median_interval_s(std::span<const Timestamp> times);

/// Detector of the configuration; none if the mask is off.
/// @throws InputError if the input lacks data that the detector requires, or a network cannot be loaded
[[nodiscard]] std::unique_ptr<ObjectDetector> make_detector(const SensorInput& input,
                                                            const OdometryConfig& config);

/// Executes and times the detector.
[[nodiscard]] DetectionJob detect_objects(ObjectDetector& detector, const Frame& frame);

/// The frames of a sequence in the order in which they arrive, without those that arrive too late.
///
/// Frames enter the odometry in temporal order: an arrival after that of a later frame, or for the second
/// time, is ignored.
class ArrivalOrder {
 public:
  /// Each frame arrives at its timestamp, unless the input has arrivals.
  /// @throws InputError if they are not in temporal order, or one precedes the timestamp of its frame
  explicit ArrivalOrder(const SensorInput& input);

  /// Number of frames that enter.
  [[nodiscard]] std::size_t count() const { return entering_.size(); }
  /// The frames that enter, by ascending index.
  [[nodiscard]] const FrameArrival& operator[](std::size_t i) const { return entering_[i]; }
  /// The frames that do not enter.
  [[nodiscard]] const std::vector<SkippedFrame>& skipped() const { return skipped_; }

 private:
  std::vector<FrameArrival> entering_;
  std::vector<SkippedFrame> skipped_;
};

/// Loads the frames of a sequence, and counts those that cannot be read. Used by one thread at a time.
class SequenceFeed {
 public:
  /// The arguments must outlive this object. @throws InputError as `ArrivalOrder`
  SequenceFeed(const SensorInput& input, const OdometryConfig& config, const RunControl& control)
      : input_(input), config_(config), control_(control), order_(input) {
    summary_.skipped = order_.skipped();
  }

  /// The next frame that can be read; nullopt at the end of the sequence and after `stop_requested`.
  [[nodiscard]] std::optional<FrameJob> next();

  /// Loads frame `index`; nullopt if it cannot be read.
  [[nodiscard]] std::optional<FrameJob> load(std::size_t index);

  /// Whether the run is to be stopped.
  [[nodiscard]] bool stop_requested() {
    summary_.interrupted = control_.stop_requested && control_.stop_requested();
    return summary_.interrupted;
  }

  /// Adds all samples to `odometry` that a frame at `t` may need. @return false if the last ones are missing
  template <class Odometry>
  bool add_imu(Timestamp t, Odometry& odometry) {
    const Timestamp end = last_imu_end_of(t, config_, input_.rig);
    while (next_sample_ < input_.imu.size()) {
      const ImuSample& sample = input_.imu[next_sample_++];
      odometry.add_imu(sample);
      if (sample.t >= end) return true;
    }
    return false;
  }

  [[nodiscard]] const ArrivalOrder& order() const { return order_; }
  /// Contains `frames`, `skipped` and `interrupted`.
  [[nodiscard]] RunSummary& summary() { return summary_; }

  /// The summary with the final state of the IMU and of the detector.
  /// @throws InputError if no frame could be read
  [[nodiscard]] RunSummary completed(const ImuHealth& imu_health, const ObjectDetector& detector) &&;

 private:
  const SensorInput& input_;
  const OdometryConfig& config_;
  const RunControl& control_;
  ArrivalOrder order_;
  std::size_t next_ = 0;  ///< in `order_`
  std::size_t next_sample_ = 0;
  RunSummary summary_;
};

}  // namespace stillpoint
