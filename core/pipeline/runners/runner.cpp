// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/runner.h"

#include <algorithm>
#include <utility>

#include "core/detector/opencv_threads.h"
#include "core/pipeline/odometry.h"
#include "core/pipeline/runners/sequence_feed.h"
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
  SequenceFeed feed(input, config, control);
  int resets = 0;
  while (const std::optional<FrameJob> job = feed.next()) {
    const Frame& frame = job->frame;
    feed.add_imu(frame.t, odometry);
    DetectionJob detections;
    if (odometry.enters_window(frame.t)) detections = detect_objects(*detector, frame);
    OdometryUpdate& update = odometry.track(frame, detections.set);
    update.timings.add(*job->decoding, 1);
    if (detections.timing) update.timings.add(*detections.timing, 1);
    resets += update.counters.reset;
    notify(control.on_frame, {.frame = frame,
                              .tracked = odometry.tracked(),
                              .dynamic = odometry.dynamic(),
                              .update = update,
                              .available = imu_end_of(frame.t, update.time_offset_s)});
  }
  RunSummary summary = std::move(feed).completed(odometry.imu_health(), *detector);
  summary.resets = resets;
  summary.loops = odometry.finish_loops();
  return summary;
}

RunSummary run_pipelined(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  const ScopedOpencvThreads threads(config.detector.threads);
  const std::unique_ptr<ObjectDetector> detector = make_detector(input, config);
  int resets = 0;  // written by the optimization thread
  FrameCallbacks on_frame = control.on_frame;
  on_frame.emplace_back([&](const FrameReport& report) { resets += report.update.counters.reset; });
  ThreadedOdometry odometry(config, input.rig,
                            {.detect = [&](const Frame& frame) { return detector->detect(frame); },
                             .on_frame = std::move(on_frame)});
  if (input.map) odometry.use_map(*input.map);
  SequenceFeed feed(input, config, control);
  while (std::optional<FrameJob> job = feed.next()) {
    if (!feed.add_imu(job->frame.t, odometry)) odometry.finish_imu();
    odometry.add_frame(std::move(job->frame), job->decoding);
  }
  odometry.finish();
  RunSummary summary = std::move(feed).completed(odometry.imu_health(), *detector);
  summary.resets = resets;
  summary.loops = odometry.finish_loops();
  summary.waits = odometry.waits();
  return summary;
}

}  // namespace stillpoint
