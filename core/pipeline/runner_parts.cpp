// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runner_parts.h"

#include <algorithm>
#include <chrono>

#include "core/base/error.h"

namespace stillpoint {
namespace {

ModuleSpan span_since(std::chrono::steady_clock::time_point start, Module module) {
  return {.module = module, .start = start, .elapsed = std::chrono::steady_clock::now() - start};
}

}  // namespace

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
  const auto start = std::chrono::steady_clock::now();
  try {
    picture.frame = input.load_frame(index);
  } catch (const InputError& error) {
    skipped.push_back({index, error.what()});
    return std::nullopt;
  }
  picture.decoding = span_since(start, Module::kImageDecoding);
  return picture;
}

DetectionOnWay detect_objects(ObjectDetector& detector, const Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  DetectionOnWay found{.set = detector.detect(frame), .search = {}};
  found.search = span_since(start, Module::kObjectDetection);
  return found;
}

void close_picture(const PictureOnWay& picture, const std::optional<DetectionOnWay>& detections,
                   OptimizationStage& optimization, const RunControl& control, RunSummary& summary) {
  OdometryUpdate& update = picture.full ? optimization.process(picture.tracked, detections->set)
                                        : optimization.predict(picture.tracked);
  update.timings.add(picture.decoding, 1);
  update.timings.add(picture.tracked.timings);
  if (detections && detections->search) update.timings.add(*detections->search, 1);
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
