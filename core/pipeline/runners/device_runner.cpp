// SPDX-License-Identifier: BSD-3-Clause
// Device runner: single-threaded discrete-event simulation of `run_realtime` on a target device.
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "core/base/error.h"
#include "core/detector/opencv_threads.h"
#include "core/pipeline/assembly.h"
#include "core/pipeline/loop_worker.h"
#include "core/pipeline/runners/device_cores.h"
#include "core/pipeline/runners/runner_parts.h"
#include "core/pipeline/stages/optimize_frame.h"

namespace stillpoint {
namespace {

using Time = DeviceCores::Time;

/// Detections of a frame, and the time at which they are available.
struct DeviceDetection {
  DetectionJob job;
  Time available_at{};
};

/// Feedback of the optimization, and the time at which it is available.
struct DeviceFeedback {
  Feedback feedback;
  Time available_at{};
};

Time cost_of(const StageCost& cost, const ModuleTime& measured) {
  if (cost.fixed_ms) return Time(std::llround(1e6 * *cost.fixed_ms));
  return Time(std::llround(cost.factor * static_cast<double>(measured.ns)));
}

class DeviceRun {
 public:
  DeviceRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control,
            const DeviceClock& clock)
      : input_(input),
        config_(config),
        control_(control),
        clock_(clock),
        order_(input),
        stages_(assemble(input, config)),
        cores_(clock.device.cores),
        imu_of_tracker_(input.imu),
        imu_of_estimator_(input.imu) {
    report_.deadline_ms = 1e3 * median_interval_s(input.frame_times) / clock.speed;
    if (config.loop.enabled) loop_ = std::make_unique<LoopWorker>(config, input.rig, LoopExecution::kInline);
    if (loop_ && input.map) loop_->use_map(*input.map);
    summary_.skipped = order_.skipped();
    feedback_.push_back({stages_.optimization.feedback(), Time{}});
  }

  RunSummary run() {
    while (const std::optional<FrameArrival> arrival = next_frame()) {
      if (control_.stop_requested && control_.stop_requested()) {
        summary_.interrupted = true;
        break;
      }
      LoadedFrame loaded = load_frame(input_, arrival->index);
      if (loaded.job) {
        process(*loaded.job, virtual_time(loaded.job->frame.t));
      } else {
        summary_.skipped.push_back({arrival->index, std::move(loaded.error)});
      }
    }
    if (loop_) summary_.loops = loop_->finish(stages_.optimization);
    summary_.realtime = std::move(report_);
    return completed(std::move(summary_), stages_.optimization.imu_health(), *stages_.detector);
  }

 private:
  [[nodiscard]] Time virtual_time(Timestamp t) const {
    const double seconds = seconds_between(input_.frame_times.front(), t);
    return Time(std::llround(1e9 * seconds / clock_.speed));
  }

  /// The recorded time that corresponds to a time of the virtual clock.
  [[nodiscard]] Timestamp recorded_time(Time time) const {
    return after(input_.frame_times.front(), 1e-9 * clock_.speed * static_cast<double>(time.count()));
  }

  /// The next frame that the tracker accepts; advances `now_` to that time.
  std::optional<FrameArrival> next_frame() {
    const std::size_t count = order_.count();
    if (next_ >= count) return std::nullopt;
    now_ = std::max(now_, virtual_time(order_[next_].t));
    std::size_t arrived = next_;
    while (arrived < count && virtual_time(order_[arrived].t) <= now_) ++arrived;
    const std::size_t queued = std::min(arrived - next_, kMaxQueuedFrames);
    report_.dropped += static_cast<int>(arrived - next_ - queued);
    next_ = arrived - queued;
    summary_.frames = std::max(summary_.frames, order_[arrived - 1].index + 1);
    return order_[next_++];
  }

  /// Newest feedback that is available at `now_`.
  [[nodiscard]] const Feedback& available_feedback() {
    while (feedback_.size() > 1 && feedback_[1].available_at <= now_) feedback_.pop_front();
    return feedback_.front().feedback;
  }

  void process(FrameJob& job, Time exposed) {
    const Feedback& feedback = available_feedback();
    imu_of_tracker_.feed_until(imu_end_of(job.frame.t, feedback.motion.time_offset_s), stages_.tracking);
    imu_of_estimator_.feed_until(imu_end_of(job.frame.t, stages_.optimization.motion_state().time_offset_s),
                                 stages_.optimization);
    job.enters_window = stages_.rate.admits(job.frame.t);
    job.tracked = stages_.tracking.process(job.frame, job.enters_window, feedback);
    const Time tracked_at =
        cores_.occupy(now_, cost_of(clock_.device.tracking, job.tracked.timings[Module::kTrackingThread]));
    if (job.enters_window) detect(job.frame);
    // Queue of one tracked frame: the tracker continues when the previous one has been dequeued.
    now_ = std::max(tracked_at, optimization_start_);
    optimize(job, tracked_at, exposed);
  }

  /// A busy detector skips the frame.
  void detect(const Frame& frame) {
    if (detector_free_ > now_) return;
    DeviceDetection detection{.job = detect_objects(*stages_.detector, frame), .available_at = {}};
    const bool is_disabled = config_.detector.kind == DetectorKind::kNone;
    const Time cost = is_disabled ? Time{}
                                  : cost_of(clock_.device.detection,
                                            {.ns = detection.job.timing->elapsed.count(), .calls = 1});
    detection.available_at =
        clock_.device.detector_has_own_processor ? now_ + cost : cores_.occupy(now_, cost);
    detector_free_ = detection.available_at;
    detections_.push_back(std::move(detection));
  }

  void optimize(const FrameJob& job, Time ready, Time exposed) {
    Time start = std::max(ready, optimizer_free_);
    std::optional<DetectionJob> found;
    if (job.enters_window) {
      start = end_of_detection_wait(job.frame.t, start);
      found = take_detection(job.frame.t, start);
    }
    OdometryUpdate& update = optimize_frame(job, found, stages_.optimization);
    const ModuleTime measured = update.timings[Module::kOptimizationThread];
    if (loop_) loop_->correct(stages_.optimization, update);
    summary_.resets += update.counters.reset;
    const bool free = !job.enters_window && clock_.device.optimization.fixed_ms;
    const Time cost = free ? Time{} : cost_of(clock_.device.optimization, measured);
    optimization_start_ = start;
    optimizer_free_ = cores_.occupy(start, cost);
    report_.latencies_ms.push_back(1e-6 * static_cast<double>((optimizer_free_ - exposed).count()));
    notify(control_, {.frame = job.frame,
                      .tracked = job.tracked,
                      .dynamic = stages_.optimization.dynamic(),
                      .update = update,
                      .available = recorded_time(optimizer_free_)});
    feedback_.push_back({stages_.optimization.feedback(), optimizer_free_});
  }

  /// Time at which the detections of the frame at `t` are available or the wait for them times out.
  [[nodiscard]] Time end_of_detection_wait(Timestamp t, Time start) const {
    const Time limit = start + Time(std::llround(1e6 * kDetectionWaitFraction * report_.deadline_ms));
    const bool own = !detections_.empty() && detections_.back().job.set.t == t;
    return own && detections_.back().available_at <= limit ? std::max(start, detections_.back().available_at)
                                                           : limit;
  }

  /// Detections for a frame at the end of the wait, by the rules of `DetectionQueue::take`.
  DetectionJob take_detection(Timestamp t, Time end_of_wait) {
    std::optional<DetectionJob> newest;
    while (!detections_.empty() && detections_.front().available_at <= end_of_wait) {
      newest = std::move(detections_.front().job);
      detections_.pop_front();
    }
    const bool usable = newest && seconds_between(newest->set.t, t) <= config_.pipeline.detection_max_age_s;
    if (!usable) newest = {.set = {.t = t, .state = DetectionState::kLate, .detections = {}}, .timing = {}};
    report_.late_detections += newest->set.state == DetectionState::kLate;
    return std::move(*newest);
  }

  const SensorInput& input_;
  const OdometryConfig& config_;
  const RunControl& control_;
  const DeviceClock& clock_;
  ArrivalOrder order_;
  Stages stages_;
  std::unique_ptr<LoopWorker> loop_;  ///< null if off
  RunSummary summary_;
  RealtimeReport report_;
  DeviceCores cores_;
  ImuFeed imu_of_tracker_;
  ImuFeed imu_of_estimator_;
  std::size_t next_ = 0;  ///< in `order_`
  Time now_{};            ///< of the tracker
  Time detector_free_{};
  Time optimizer_free_{};
  Time optimization_start_{};               ///< of the previous frame
  std::deque<DeviceDetection> detections_;  ///< not used yet
  std::deque<DeviceFeedback> feedback_;     ///< the first is available, the others in the future
};

}  // namespace

RunSummary run_on_device(const SensorInput& input, const OdometryConfig& config, const RunControl& control,
                         const DeviceClock& clock) {
  if (!(clock.speed > 0.0)) throw InputError("--speed", "must be larger than 0; 1 is as recorded");
  if (input.frame_times.empty()) return {};
  const ScopedOpencvThreads threads(config.detector.threads);
  return DeviceRun(input, config, control, clock).run();
}

}  // namespace stillpoint
