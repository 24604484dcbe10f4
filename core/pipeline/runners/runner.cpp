// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/runner.h"

#include <algorithm>
#include <utility>

#include "core/detector/opencv_threads.h"
#include "core/pipeline/assembly.h"
#include "core/pipeline/odometry.h"
#include "core/pipeline/runners/runner_parts.h"
#include "core/pipeline/threaded_odometry.h"

namespace stillpoint {

int RealtimeReport::deadline_misses() const {
  return static_cast<int>(
      std::ranges::count_if(latencies_ms, [this](double latency) { return latency > deadline_ms; }));
}

RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  const ScopedOpencvThreads threads(config.detector.threads);
  const std::unique_ptr<ObjectDetector> detector = make_detector(input, config);
  Odometry odometry(config, input.rig);
  if (input.map) odometry.use_map(*input.map);
  FrameLoader loader(input, control);
  ImuFeed imu(input.imu);
  int resets = 0;
  while (const std::optional<FrameJob> job = loader.next()) {
    const Frame& frame = job->frame;
    imu.feed_through(last_imu_end_of(frame.t, config, input.rig), odometry);
    DetectionJob detections;
    if (odometry.enters_window(frame.t)) detections = detect_objects(*detector, frame);
    OdometryUpdate& update = odometry.track(frame, detections.set);
    update.timings.add(*job->decoding, 1);
    if (detections.timing) update.timings.add(*detections.timing, 1);
    resets += update.counters.reset;
    notify(control, {.frame = frame,
                     .tracked = odometry.tracked(),
                     .dynamic = odometry.dynamic(),
                     .update = update,
                     .available = imu_end_of(frame.t, update.time_offset_s)});
  }
  RunSummary summary = completed(loader.summary(), odometry.imu_health(), *detector);
  summary.resets = resets;
  summary.loops = odometry.finish_loops();
  return summary;
}

RunSummary run_pipelined(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  const ScopedOpencvThreads threads(config.detector.threads);
  const std::unique_ptr<ObjectDetector> detector = make_detector(input, config);
  int resets = 0;  // written by the optimization thread
  ThreadedOdometry odometry(config, input.rig,
                            {.detect = [&](const Frame& frame) { return detector->detect(frame); },
                             .on_update =
                                 [&](const OdometryUpdate& update) {
                                   resets += update.counters.reset;
                                   if (control.on_update) control.on_update(update);
                                 },
                             .on_frame = control.on_frame});
  if (input.map) odometry.use_map(*input.map);
  FrameLoader loader(input, control);
  ImuFeed imu(input.imu);
  while (std::optional<FrameJob> job = loader.next()) {
    if (!imu.feed_through(last_imu_end_of(job->frame.t, config, input.rig), odometry)) {
      odometry.finish_imu();
    }
    odometry.add_frame(std::move(job->frame), job->decoding);
  }
  odometry.finish();
  RunSummary summary = completed(loader.summary(), odometry.imu_health(), *detector);
  summary.resets = resets;
  summary.loops = odometry.finish_loops();
  summary.waits = odometry.waits();
  return summary;
}

}  // namespace stillpoint
