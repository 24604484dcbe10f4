// SPDX-License-Identifier: BSD-3-Clause
// The runner with a thread for each stage, and the same bits as one thread. Paper Sec. II.
#include <thread>
#include <utility>

#include "core/base/bounded_channel.h"
#include "core/base/thread_name.h"
#include "core/pipeline/runner_parts.h"
#include "core/pipeline/thread_errors.h"

namespace stillpoint {
namespace {

/// Pictures that may wait between two stages.
constexpr std::size_t kWaiting = 4;

class PipelinedRun {
 public:
  PipelinedRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control)
      : input_(input),
        control_(control),
        stages_(assemble(input, config)),
        feedback_(static_cast<std::size_t>(config.pipeline.feedback_lag) + 2) {
    // The tracker takes one of these for each picture, and waits where there is none: that is the lag.
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
    summary_.waits = {to_detect_.waits("pictures to detect in"), tracked_.waits("tracked pictures"),
                      detected_.waits("detections"), feedback_.waits("feedback to the tracker")};
    close_run(stages_, summary_);
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
      std::optional<PictureOnWay> picture = load_picture(input_, i, summary_.skipped);
      if (!picture) continue;
      picture->full = stages_.rate.admits(picture->frame.t);
      if (picture->full && !to_detect_.push(picture->frame)) return;
      std::optional<Returned> returned = feedback_.pop();
      if (!returned) return;
      imu.up_to(after(picture->frame.t, input_.rig.time_offset_s + kImuLead_s), stages_.tracking);
      picture->tracked =
          stages_.tracking.process(picture->frame, picture->full, returned->said, std::move(returned->spent));
      picture->told = std::move(returned->said);
      if (!tracked_.push(std::move(*picture))) return;
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
    while (std::optional<PictureOnWay> picture = tracked_.pop()) {
      std::optional<DetectionOnWay> detections;
      if (picture->full) {
        detections = detected_.pop();
        if (!detections) return;
      }
      imu.up_to(after(picture->frame.t, input_.rig.time_offset_s + kImuLead_s), stages_.optimization);
      close_picture(*picture, detections, stages_.optimization, control_, summary_);
      feedback_.push({stages_.optimization.feedback(std::move(picture->told)), std::move(picture->tracked)});
    }
  }

  /// Lets every thread come to its end.
  void close() {
    to_detect_.close();
    tracked_.close();
    detected_.close();
    feedback_.close();
  }

  const SensorInput& input_;
  const RunControl& control_;
  Stages stages_;
  RunSummary summary_;  ///< `frames`, `skipped`, `interrupted` belong to the tracker's thread while it runs
  BoundedChannel<Returned> feedback_;
  BoundedChannel<Frame> to_detect_{kWaiting};
  BoundedChannel<PictureOnWay> tracked_{kWaiting};
  BoundedChannel<DetectionOnWay> detected_{kWaiting};
  ThreadErrors errors_;
};

}  // namespace

RunSummary run_pipelined(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  return PipelinedRun(input, config, control).run();
}

}  // namespace stillpoint
