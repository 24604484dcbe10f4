// SPDX-License-Identifier: BSD-3-Clause
// The runner against the clock: pictures come when their stamps say, and nobody waits for the slowest stage.
#include <thread>

#include "core/base/bounded_channel.h"
#include "core/base/error.h"
#include "core/base/thread_name.h"
#include "core/pipeline/newest_detections.h"
#include "core/pipeline/pacing_clock.h"
#include "core/pipeline/runner_parts.h"
#include "core/pipeline/thread_errors.h"

namespace stillpoint {
namespace {

/// Inertial samples that the optimisation waits for after an exposure: the cut is interpolated, and the time
/// offset may grow. Less than offline, since it is paid for in latency.
constexpr double kRealtimeImuLead_s = 0.005;

class RealtimeRun {
 public:
  RealtimeRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control, double speed)
      : input_(input),
        config_(config),
        control_(control),
        stages_(assemble(input, config)),
        clock_(input.frame_times.empty() ? Timestamp{} : input.frame_times.front(), speed) {
    report_.deadline_ms = 1e3 * median_interval_s(input.frame_times) / speed;
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
    summary_.waits = {exposed_.waits("exposed pictures"), to_detect_.waits("pictures to detect in"),
                      tracked_.waits("tracked pictures")};
    summary_.realtime = std::move(report_);
    close_run(stages_, summary_);
    return std::move(summary_);
  }

 private:
  void expose() {
    name_this_thread("camera");
    for (std::size_t i = 0; i < input_.frame_times.size(); ++i) {
      if (!clock_.wait_until(input_.frame_times[i], control_.stop_requested)) {
        summary_.interrupted = true;
        break;
      }
      ++summary_.frames;
      std::optional<PictureOnWay> picture = load_picture(input_, i, summary_.skipped);
      if (picture) report_.dropped += exposed_.push_dropping_oldest(std::move(*picture)).has_value();
    }
    exposed_.close();
  }

  void track() {
    name_this_thread("tracking");
    ImuFeed imu(input_.imu);
    Returned newest;
    while (std::optional<PictureOnWay> picture = exposed_.pop()) {
      picture->full = stages_.rate.admits(picture->frame.t);
      if (picture->full) to_detect_.push_dropping_oldest(picture->frame);
      if (std::optional<Returned> newer = feedback_.pop_for({})) {
        picture->told = std::move(newest.said);
        newest = std::move(*newer);
      }
      const Feedback& known = newest.said;
      imu.up_to(after(picture->frame.t, known.motion.time_offset_s), stages_.tracking);
      picture->tracked =
          stages_.tracking.process(picture->frame, picture->full, known, std::move(newest.spent));
      if (!tracked_.push(std::move(*picture))) return;
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
    while (std::optional<PictureOnWay> picture = tracked_.pop()) {
      const Timestamp t = picture->frame.t;
      const Timestamp imu_end = after(t, stages_.optimization.knowledge().time_offset_s + kRealtimeImuLead_s);
      clock_.wait_until(imu_end, {});
      imu.up_to(imu_end, stages_.optimization);
      close_picture(*picture, detections_for(*picture), stages_.optimization, control_, summary_);
      report_.latencies_ms.push_back(1e3 * clock_.wall_seconds_late(t));
      feedback_.push_dropping_oldest(
          {stages_.optimization.feedback(std::move(picture->told)), std::move(picture->tracked)});
    }
  }

  std::optional<DetectionOnWay> detections_for(const PictureOnWay& picture) {
    if (!picture.full) return std::nullopt;
    const std::chrono::duration<double, std::milli> wait(kDetectionWait * report_.deadline_ms);
    DetectionOnWay found =
        detected_.take(picture.frame.t, std::chrono::duration_cast<std::chrono::nanoseconds>(wait),
                       config_.pipeline.detection_max_age_s);
    report_.late_detections += found.set.state == DetectionState::kLate;
    return found;
  }

  /// Lets every thread come to its end.
  void close() {
    exposed_.close();
    to_detect_.close();
    tracked_.close();
  }

  const SensorInput& input_;
  const OdometryConfig& config_;
  const RunControl& control_;
  Stages stages_;
  RunSummary summary_;     ///< `frames`, `skipped`, `interrupted` belong to the camera's thread while it runs
  RealtimeReport report_;  ///< `dropped` likewise
  PacingClock clock_;
  BoundedChannel<PictureOnWay> exposed_{kWaitingPictures};
  BoundedChannel<Frame> to_detect_{1};
  BoundedChannel<PictureOnWay> tracked_{1};
  BoundedChannel<Returned> feedback_{1};
  NewestDetections detected_;
  ThreadErrors errors_;
};

}  // namespace

RunSummary run_realtime(const SensorInput& input, const OdometryConfig& config, const RunControl& control,
                        double speed) {
  if (!(speed > 0.0)) throw InputError("--speed", "must be larger than 0; 1 is as recorded");
  return RealtimeRun(input, config, control, speed).run();
}

}  // namespace stillpoint
