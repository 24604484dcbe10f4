// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runner_parts.h"

#include <algorithm>

#include "core/base/error.h"

namespace stillpoint {

double median_interval_s(std::span<const Timestamp> times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(seconds_between(times[i - 1], times[i]));
  if (intervals.empty()) return 0.0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}

std::optional<PictureOnWay> load_picture(const SensorInput& input, std::size_t index,
                                         std::vector<SkippedFrame>& skipped) {
  PictureOnWay picture;
  const ScopedTimer timer(picture.decoding, Module::kImageDecoding);
  try {
    picture.frame = input.load_frame(index);
  } catch (const InputError& error) {
    skipped.push_back({index, error.what()});
    return std::nullopt;
  }
  return picture;
}

DetectionOnWay detect_objects(ObjectDetector& detector, const Frame& frame) {
  DetectionOnWay found;
  const ScopedTimer timer(found.timings, Module::kObjectDetection);
  found.set = detector.detect(frame);
  return found;
}

void close_picture(const PictureOnWay& picture, const std::optional<DetectionOnWay>& detections,
                   OptimizationStage& optimization, const RunControl& control, RunSummary& summary) {
  OdometryUpdate& update = picture.full ? optimization.process(picture.tracked, detections->set)
                                        : optimization.predict(picture.tracked);
  update.timings.add(picture.decoding);
  update.timings.add(picture.tracked.timings);
  if (detections) update.timings.add(detections->timings);
  summary.resets += update.counters.reset;
  if (control.on_update) control.on_update(update);
  if (control.on_picture) {
    control.on_picture({.frame = picture.frame,
                        .tracked = picture.tracked,
                        .dynamic = optimization.dynamic(),
                        .update = update});
  }
}

void close_run(const Stages& stages, RunSummary& summary) {
  summary.imu_health = stages.optimization.imu_health();
  summary.detector = stages.detector->description();
  summary.detector_counters = stages.detector->counters();
  if (summary.frames > 0 && summary.skipped.size() == summary.frames) {
    throw InputError("no picture of the sequence could be read; the first: " +
                     summary.skipped.front().reason);
  }
}

}  // namespace stillpoint
