// SPDX-License-Identifier: BSD-3-Clause
// Real-time runner: frames are delivered at their timestamps; slow stages drop frames instead of blocking.
#include <memory>
#include <thread>

#include "core/base/bounded_channel.h"
#include "core/base/error.h"
#include "core/base/thread_name.h"
#include "core/detector/opencv_threads.h"
#include "core/pipeline/assembly.h"
#include "core/pipeline/loop_worker.h"
#include "core/pipeline/runners/detection_queue.h"
#include "core/pipeline/runners/pacing_clock.h"
#include "core/pipeline/runners/runner_parts.h"
#include "core/pipeline/stages/optimize_frame.h"
#include "core/pipeline/thread_errors.h"

namespace stillpoint {
namespace {

/// The optimization waits for IMU samples up to this much later than a frame: the sample at the exposure is
/// interpolated, and the estimated time offset may increase. Less than offline, since it adds to the latency.
constexpr double kRealtimeImuLookahead_s = 0.005;

class RealtimeRun {
 public:
  RealtimeRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control, double speed)
      : input_(input),
        config_(config),
        control_(control),
        stages_(assemble(input, config)),
        order_(input),
        clock_(input.frame_times.empty() ? Timestamp{} : input.frame_times.front(), speed) {
    report_.deadline_ms = 1e3 * median_interval_s(input.frame_times) / speed;
    if (config.loop.enabled)
      loop_ = std::make_unique<LoopWorker>(config, input.rig, LoopExecution::kRealtime);
    if (loop_ && input.map) loop_->use_map(*input.map);
    summary_.skipped = order_.skipped();
    feedback_.push({stages_.optimization.feedback(), {}});
  }

  RunSummary run() {
    {
      const auto start = [this](auto work) {
        return std::jthread([this, work] { errors_.guard([&] { (this->*work)(); }, [this] { close(); }); });
      };
      const std::jthread camera = start(&RealtimeRun::expose);
      const std::jthread tracker = start(&RealtimeRun::track);
      const std::jthread detector = start(&RealtimeRun::detect);
      errors_.guard([this] { optimize(); }, [this] { close(); });
    }
    errors_.rethrow();
    summary_.waits = {exposed_.waits("exposed frames"), to_detect_.waits("frames to detect"),
                      tracked_.waits("tracked frames")};
    if (loop_) summary_.loops = loop_->finish(stages_.optimization);
    summary_.realtime = std::move(report_);
    return completed(std::move(summary_), stages_.optimization.imu_health(), *stages_.detector);
  }

 private:
  void expose() {
    name_this_thread("camera");
    for (std::size_t k = 0; k < order_.count(); ++k) {
      const std::size_t i = order_[k].index;
      if (!clock_.wait_until(order_[k].t, control_.stop_requested)) {
        summary_.interrupted = true;
        break;
      }
      summary_.frames = i + 1;
      LoadedFrame loaded = load_frame(input_, i);
      if (loaded.job) {
        report_.dropped += exposed_.push_dropping_oldest(std::move(*loaded.job)).has_value();
      } else {
        summary_.skipped.push_back({i, std::move(loaded.error)});
      }
    }
    exposed_.close();
  }

  void track() {
    name_this_thread("tracking");
    ImuFeed imu(input_.imu);
    TrackerFeedback newest;
    while (std::optional<FrameJob> job = exposed_.pop()) {
      job->enters_window = stages_.rate.admits(job->frame.t);
      if (job->enters_window) to_detect_.push_dropping_oldest(job->frame);
      if (std::optional<TrackerFeedback> newer = feedback_.pop_for({})) {
        job->feedback = std::move(newest.feedback);
        newest = std::move(*newer);
      }
      const Feedback& feedback = newest.feedback;
      imu.feed_until(after(job->frame.t, feedback.motion.time_offset_s), stages_.tracking);
      job->tracked = stages_.tracking.process(job->frame, job->enters_window, feedback,
                                              std::move(newest.recycled_frame));
      if (!tracked_.push(std::move(*job))) return;
    }
    to_detect_.close();
    tracked_.close();
  }

  void detect() {
    name_this_thread("detection");
    while (const std::optional<Frame> frame = to_detect_.pop()) {
      detected_.put(detect_objects(*stages_.detector, *frame));
    }
  }

  void optimize() {
    ImuFeed imu(input_.imu);
    while (std::optional<FrameJob> job = tracked_.pop()) {
      const Timestamp t = job->frame.t;
      const Timestamp imu_end =
          after(t, stages_.optimization.motion_state().time_offset_s + kRealtimeImuLookahead_s);
      clock_.wait_until(imu_end, {});
      imu.feed_until(imu_end, stages_.optimization);
      OdometryUpdate& update = optimize_frame(*job, detections_for(*job), stages_.optimization);
      if (loop_) loop_->correct(stages_.optimization, update);
      summary_.resets += update.counters.reset;
      notify(control_, {.frame = job->frame,
                        .tracked = job->tracked,
                        .dynamic = stages_.optimization.dynamic(),
                        .update = update,
                        .available = after(t, clock_.seconds_late(t))});
      report_.latencies_ms.push_back(1e3 * clock_.wall_seconds_late(t));
      feedback_.push_dropping_oldest(
          {stages_.optimization.feedback(std::move(job->feedback)), std::move(job->tracked)});
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

  const SensorInput& input_;
  const OdometryConfig& config_;
  const RunControl& control_;
  Stages stages_;
  std::unique_ptr<LoopWorker> loop_;  ///< null if off
  RunSummary summary_;     ///< `frames`, `skipped`, `interrupted`: camera thread only, while it runs
  RealtimeReport report_;  ///< same for `dropped`
  ArrivalOrder order_;
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
