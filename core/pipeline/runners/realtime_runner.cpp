// SPDX-License-Identifier: BSD-3-Clause
// Real-time runner: frames are delivered at their timestamps; slow stages drop frames instead of blocking.
#include <memory>
#include <thread>

#include "core/base/bounded_channel.h"
#include "core/base/error.h"
#include "core/base/thread_name.h"
#include "core/detector/opencv_threads.h"
#include "core/pipeline/frame_stepper.h"
#include "core/pipeline/runners/pacing.h"
#include "core/pipeline/runners/sequence_feed.h"
#include "core/pipeline/thread_errors.h"

namespace stillpoint {
namespace {

/// The optimization waits for IMU samples up to this much later than a frame: the sample at the exposure is
/// interpolated, and the estimated time offset may increase. Less than offline, since it adds to the latency.
constexpr ImuLookahead kLookahead{.tracking_s = 0.0, .optimization_s = 0.005};

class RealtimeRun {
 public:
  RealtimeRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control, double speed)
      : config_(config),
        control_(control),
        feed_(input, config, control),
        detector_(make_detector(input, config)),
        stepper_(config, input.rig, LoopExecution::kRealtime, kLookahead),
        clock_(input.frame_times.empty() ? Timestamp{} : input.frame_times.front(), speed) {
    report_.deadline_ms = 1e3 * median_interval_s(input.frame_times) / speed;
    if (input.map) stepper_.use_map(*input.map);
    feedback_.push({stepper_.feedback(), {}});
  }

  RunSummary run() {
    {
      const std::jthread camera = start(&RealtimeRun::expose);
      const std::jthread tracker = start(&RealtimeRun::track);
      const std::jthread detector = start(&RealtimeRun::detect);
      errors_.guard([this] { optimize(); }, [this] { close(); });
    }
    errors_.rethrow();
    RunSummary summary = std::move(feed_).completed(stepper_.imu_health(), *detector_);
    summary.resets = resets_;
    summary.waits = {exposed_.waits("exposed frames"), to_detect_.waits("frames to detect"),
                     tracked_.waits("tracked frames")};
    summary.loops = stepper_.finish_loops();
    summary.realtime = std::move(report_);
    return summary;
  }

 private:
  std::jthread start(void (RealtimeRun::*work)()) {
    return std::jthread([this, work] { errors_.guard([&] { (this->*work)(); }, [this] { close(); }); });
  }

  /// Delivers the frames and their samples at the recorded times.
  void expose() {
    name_this_thread("camera");
    const ArrivalOrder& order = feed_.order();
    for (std::size_t k = 0; k < order.count(); ++k) {
      if (!clock_.wait_until(order[k].t, control_.stop_requested)) {
        feed_.summary().interrupted = true;
        break;
      }
      if (std::optional<FrameJob> job = feed_.load(order[k].index)) {
        feed_.add_imu(job->frame.t, stepper_);
        report_.dropped += exposed_.push_dropping_oldest(std::move(*job)).has_value();
      }
    }
    exposed_.close();
  }

  void track() {
    name_this_thread("tracking");
    TrackerFeedback newest;
    while (std::optional<FrameJob> job = exposed_.pop()) {
      job->enters_window = stepper_.enters_window(job->frame.t);
      if (job->enters_window) to_detect_.push_dropping_oldest(job->frame);
      if (std::optional<TrackerFeedback> newer = feedback_.pop_for({})) {
        job->feedback = std::move(newest.feedback);
        newest = std::move(*newer);
      }
      job->tracked = stepper_.track(job->frame, newest.feedback, std::move(newest.recycled_frame));
      if (!tracked_.push(std::move(*job))) return;
    }
    to_detect_.close();
    tracked_.close();
  }

  void detect() {
    name_this_thread("detection");
    while (const std::optional<Frame> frame = to_detect_.pop()) {
      detected_.put(detect_objects(*detector_, *frame));
    }
  }

  void optimize() {
    while (std::optional<FrameJob> job = tracked_.pop()) {
      const Timestamp t = job->frame.t;
      clock_.wait_until(after(t, stepper_.time_offset_s() + kLookahead.optimization_s), {});
      const OdometryUpdate& update = stepper_.optimize(*job, detections_for(*job));
      resets_ += update.counters.reset;
      notify(control_.on_frame, {.frame = job->frame,
                                 .tracked = job->tracked,
                                 .dynamic = stepper_.dynamic(),
                                 .update = update,
                                 .available = after(t, clock_.seconds_late(t))});
      report_.latencies_ms.push_back(1e3 * clock_.wall_seconds_late(t));
      feedback_.push_dropping_oldest({stepper_.feedback(std::move(job->feedback)), std::move(job->tracked)});
    }
  }

  std::optional<DetectionJob> detections_for(const FrameJob& job) {
    if (!job.enters_window) return std::nullopt;
    const std::chrono::duration<double, std::milli> wait(kDetectionWaitFraction * report_.deadline_ms);
    DetectionJob detection =
        detected_.take(job.frame.t, std::chrono::duration_cast<std::chrono::nanoseconds>(wait),
                       config_.pipeline.detection_max_age_s);
    report_.late_detections += detection.set.state == DetectionState::kLate;
    return detection;
  }

  /// Closes the channels, so that all threads finish.
  void close() {
    exposed_.close();
    to_detect_.close();
    tracked_.close();
  }

  const OdometryConfig& config_;
  const RunControl& control_;
  SequenceFeed feed_;  ///< camera thread only, while it runs
  std::unique_ptr<ObjectDetector> detector_;
  FrameStepper stepper_;
  RealtimeReport report_;  ///< `dropped`: camera thread only, while it runs
  int resets_ = 0;
  PacingClock clock_;
  BoundedChannel<FrameJob> exposed_{kMaxQueuedFrames};
  BoundedChannel<Frame> to_detect_{1};
  BoundedChannel<FrameJob> tracked_{1};
  BoundedChannel<TrackerFeedback> feedback_{1};
  DetectionQueue detected_;
  ThreadErrors errors_;
};

}  // namespace

RunSummary run_realtime(const SensorInput& input, const OdometryConfig& config, const RunControl& control,
                        double speed) {
  if (!(speed > 0.0)) throw InputError("--speed", "must be larger than 0; 1 is as recorded");
  const ScopedOpencvThreads threads(config.detector.threads);
  return RealtimeRun(input, config, control, speed).run();
}

}  // namespace stillpoint
