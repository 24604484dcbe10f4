// SPDX-License-Identifier: BSD-3-Clause
/// Code shared by the runners: IMU feed, frame loading, detection, and the last steps of a frame.
#pragma once

#include <optional>
#include <span>

#include "core/pipeline/runners/runner.h"

namespace stillpoint {

/// IMU samples up to this much later than a frame are added before it: the sample at the exposure is
/// interpolated, and the estimated time offset may increase.
constexpr double kImuLookahead_s = 0.02;

/// Capacity of the queue before the tracker in paced modes; the oldest frame is dropped when it is full.
constexpr std::size_t kMaxQueuedFrames = 2;

/// Time that the optimization waits for detections in paced modes, as a fraction of the frame interval.
constexpr double kDetectionWaitFraction = 0.3;

/// Median interval between successive frames; 0 for fewer than two frames.
[[nodiscard]] double median_interval_s(std::span<const Timestamp> times);

/// Feeds IMU samples to a stage, up to a given time.
class ImuFeed {
 public:
  explicit ImuFeed(std::span<const ImuSample> samples) : samples_(samples) {}

  template <class Stage>
  void feed_until(Timestamp end, Stage& stage) {
    for (; next_ < samples_.size() && samples_[next_].t <= end; ++next_) stage.add_imu(samples_[next_]);
  }

 private:
  std::span<const ImuSample> samples_;
  std::size_t next_ = 0;
};

/// Message from the optimization thread to the tracking thread.
struct TrackerFeedback {
  Feedback feedback;
  TrackedFrame recycled_frame;  ///< a processed frame, whose memory the tracker reuses
};

/// A frame with its intermediate results, passed from stage to stage.
struct FrameJob {
  Frame frame;
  bool enters_window = false;
  Feedback feedback;     ///< input of the tracker; goes back to the optimization stage for reuse
  TrackedFrame tracked;  ///< result of the tracking stage
  ModuleSpan decoding;   ///< time of image decoding
};

/// Detections of a frame, and the time the detector took.
struct DetectionJob {
  DetectionSet set;
  std::optional<ModuleSpan> timing;  ///< nullopt if no detection finished in time
};

/// Loads a frame; returns nullopt and adds the reason to `skipped` if it cannot be read.
[[nodiscard]] std::optional<FrameJob> load_frame_job(const SensorInput& input, std::size_t index,
                                                     std::vector<SkippedFrame>& skipped);

[[nodiscard]] DetectionJob detect_objects(ObjectDetector& detector, const Frame& frame);

/// Last steps of a frame: optimization stage, timings, and callbacks.
/// @param detections nullopt if the frame does not enter the window
void finish_frame(const FrameJob& job, const std::optional<DetectionJob>& detections,
                  OptimizationStage& optimization, const RunControl& control, RunSummary& summary);

/// Adds the final state of the stages to the summary.
/// @throws InputError if no frame could be read
void complete_summary(const Stages& stages, RunSummary& summary);

}  // namespace stillpoint
