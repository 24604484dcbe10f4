// SPDX-License-Identifier: BSD-3-Clause
// Pipelined runner: one thread per stage, bit-identical to the sequential runner. Paper Sec. II.
#include <thread>
#include <utility>

#include "core/base/bounded_channel.h"
#include "core/base/thread_name.h"
#include "core/pipeline/runners/runner_parts.h"
#include "core/pipeline/runners/thread_errors.h"

namespace stillpoint {
namespace {

/// Capacity of the channels between the stages.
constexpr std::size_t kChannelCapacity = 4;

class PipelinedRun {
 public:
  PipelinedRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control)
      : input_(input),
        control_(control),
        stages_(assemble(input, config)),
        feedback_(static_cast<std::size_t>(config.pipeline.feedback_lag) + 2) {
    // The tracker consumes one message per frame and blocks on an empty channel: the initial messages are the
    // lag.
    for (int i = 0; i <= config.pipeline.feedback_lag; ++i) {
      feedback_.push({stages_.optimization.feedback(), {}});
    }
  }

  RunSummary run() {
    {
      const std::jthread tracker([this] { errors_.guard([this] { track(); }, [this] { close(); }); });
      const std::jthread detector([this] { errors_.guard([this] { detect(); }, [this] { close(); }); });
      errors_.guard([this] { optimize(); }, [this] { close(); });
    }
    errors_.rethrow();
    summary_.waits = {to_detect_.waits("frames to detect"), tracked_.waits("tracked frames"),
                      detected_.waits("detections"), feedback_.waits("feedback to the tracker")};
    complete_summary(stages_, summary_);
    return std::move(summary_);
  }

 private:
  void track() {
    name_this_thread("tracking");
    ImuFeed imu(input_.imu);
    for (std::size_t i = 0; i < input_.frame_times.size(); ++i) {
      if (control_.stop_requested && control_.stop_requested()) {
        summary_.interrupted = true;
        break;
      }
      ++summary_.frames;
      std::optional<FrameJob> job = load_frame_job(input_, i, summary_.skipped);
      if (!job) continue;
      job->enters_window = stages_.rate.admits(job->frame.t);
      if (job->enters_window && !to_detect_.push(job->frame)) return;
      std::optional<TrackerFeedback> message = feedback_.pop();
      if (!message) return;
      imu.feed_until(after(job->frame.t, input_.rig.time_offset_s + kImuLookahead_s), stages_.tracking);
      job->tracked = stages_.tracking.process(job->frame, job->enters_window, message->feedback,
                                              std::move(message->recycled_frame));
      job->feedback = std::move(message->feedback);
      if (!tracked_.push(std::move(*job))) return;
    }
    to_detect_.close();
    tracked_.close();
  }

  void detect() {
    name_this_thread("detection");
    while (const std::optional<Frame> frame = to_detect_.pop()) {
      if (!detected_.push(detect_objects(*stages_.detector, *frame))) return;
    }
    detected_.close();
  }

  void optimize() {
    ImuFeed imu(input_.imu);
    while (std::optional<FrameJob> job = tracked_.pop()) {
      std::optional<DetectionJob> detections;
      if (job->enters_window) {
        detections = detected_.pop();
        if (!detections) return;
      }
      imu.feed_until(after(job->frame.t, input_.rig.time_offset_s + kImuLookahead_s), stages_.optimization);
      finish_frame(*job, detections, stages_.optimization, control_, summary_);
      feedback_.push({stages_.optimization.feedback(std::move(job->feedback)), std::move(job->tracked)});
    }
  }

  /// Closes all channels, so that all threads finish.
  void close() {
    to_detect_.close();
    tracked_.close();
    detected_.close();
    feedback_.close();
  }

  const SensorInput& input_;
  const RunControl& control_;
  Stages stages_;
  RunSummary summary_;  ///< `frames`, `skipped`, `interrupted`: tracking thread only, while it runs
  BoundedChannel<TrackerFeedback> feedback_;
  BoundedChannel<Frame> to_detect_{kChannelCapacity};
  BoundedChannel<FrameJob> tracked_{kChannelCapacity};
  BoundedChannel<DetectionJob> detected_{kChannelCapacity};
  ThreadErrors errors_;
};

}  // namespace

RunSummary run_pipelined(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  return PipelinedRun(input, config, control).run();
}

}  // namespace stillpoint
