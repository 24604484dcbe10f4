// SPDX-License-Identifier: BSD-3-Clause
// Device runner: single-threaded discrete-event simulation of `run_realtime` on a target device.
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "core/base/error.h"
#include "core/detector/opencv_threads.h"
#include "core/pipeline/frame_stepper.h"
#include "core/pipeline/runners/pacing.h"
#include "core/pipeline/runners/sequence_feed.h"

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
      : start_(input.frame_times.front()),
        config_(config),
        control_(control),
        clock_(clock),
        feed_(input, config, control),
        detector_(make_detector(input, config)),
        stepper_(config, input.rig, LoopExecution::kInline),
        cores_(clock.device.cores) {
    report_.deadline_ms = 1e3 * median_interval_s(input.frame_times) / clock.speed;
    if (input.map) stepper_.use_map(*input.map);
    feedback_.push_back({stepper_.feedback(), Time{}});
  }

  RunSummary run() {
    while (const std::optional<std::size_t> index = next_frame()) {
      if (feed_.stop_requested()) break;
      std::optional<FrameJob> job = feed_.load(*index);
      if (job) process(*job, virtual_time(job->frame.t));
    }
    RunSummary summary = std::move(feed_).completed(stepper_.imu_health(), *detector_);
    summary.resets = resets_;
    summary.loops = stepper_.finish_loops();
    summary.realtime = std::move(report_);
    return summary;
  }

 private:
  [[nodiscard]] Time virtual_time(Timestamp t) const {
    const double seconds = seconds_between(start_, t);
    return Time(std::llround(1e9 * seconds / clock_.speed));
  }

  /// The recorded time that corresponds to a time of the virtual clock.
  [[nodiscard]] Timestamp recorded_time(Time time) const {
    return after(start_, 1e-9 * clock_.speed * static_cast<double>(time.count()));
  }

  /// Index of the next frame that the tracker accepts; advances `now_` to that time.
  std::optional<std::size_t> next_frame() {
    const ArrivalOrder& order = feed_.order();
    const std::size_t count = order.count();
    if (next_ >= count) return std::nullopt;
    now_ = std::max(now_, virtual_time(order[next_].t));
    std::size_t arrived = next_;
    while (arrived < count && virtual_time(order[arrived].t) <= now_) ++arrived;
    const std::size_t queued = std::min(arrived - next_, kMaxQueuedFrames);
    report_.dropped += static_cast<int>(arrived - next_ - queued);
    next_ = arrived - queued;
    feed_.summary().frames = std::max(feed_.summary().frames, order[arrived - 1].index + 1);
    return order[next_++].index;
  }

  /// Newest feedback that is available at `now_`.
  [[nodiscard]] const Feedback& available_feedback() {
    while (feedback_.size() > 1 && feedback_[1].available_at <= now_) feedback_.pop_front();
    return feedback_.front().feedback;
  }

  void process(FrameJob& job, Time exposed) {
    const Feedback& feedback = available_feedback();
    feed_.add_imu(job.frame.t, stepper_);
    job.enters_window = stepper_.enters_window(job.frame.t);
    job.tracked = stepper_.track(job.frame, feedback);
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
    DeviceDetection detection{.job = detect_objects(*detector_, frame), .available_at = {}};
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
    const OdometryUpdate& update = stepper_.optimize(job, found);
    const ModuleTime measured = update.timings[Module::kOptimizationThread];
    resets_ += update.counters.reset;
    const bool free = !job.enters_window && clock_.device.optimization.fixed_ms;
    const Time cost = free ? Time{} : cost_of(clock_.device.optimization, measured);
    optimization_start_ = start;
    optimizer_free_ = cores_.occupy(start, cost);
    report_.latencies_ms.push_back(1e-6 * static_cast<double>((optimizer_free_ - exposed).count()));
    notify(control_.on_frame, {.frame = job.frame,
                               .tracked = job.tracked,
                               .dynamic = stepper_.dynamic(),
                               .update = update,
                               .available = recorded_time(optimizer_free_)});
    feedback_.push_back({stepper_.feedback(), optimizer_free_});
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

  Timestamp start_;  ///< of the virtual clock
  const OdometryConfig& config_;
  const RunControl& control_;
  const DeviceClock& clock_;
  SequenceFeed feed_;
  std::unique_ptr<ObjectDetector> detector_;
  FrameStepper stepper_;
  RealtimeReport report_;
  int resets_ = 0;
  DeviceCores cores_;
  std::size_t next_ = 0;  ///< in the order of arrivals
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
