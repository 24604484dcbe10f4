// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/runner_parts.h"

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

std::optional<FrameJob> load_frame_job(const SensorInput& input, std::size_t index,
                                       std::vector<SkippedFrame>& skipped) {
  FrameJob job;
  const auto start = std::chrono::steady_clock::now();
  try {
    job.frame = input.load_frame(index);
  } catch (const InputError& error) {
    skipped.push_back({index, error.what()});
    return std::nullopt;
  }
  job.decoding = span_since(start, Module::kImageDecoding);
  return job;
}

DetectionJob detect_objects(ObjectDetector& detector, const Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  DetectionJob detection{.set = detector.detect(frame), .timing = {}};
  detection.timing = span_since(start, Module::kObjectDetection);
  return detection;
}

void finish_frame(const FrameJob& job, const std::optional<DetectionJob>& detections,
                  OptimizationStage& optimization, const RunControl& control, RunSummary& summary) {
  OdometryUpdate& update = job.enters_window ? optimization.process(job.tracked, detections->set)
                                             : optimization.predict(job.tracked);
  update.timings.add(job.decoding, 1);
  update.timings.add(job.tracked.timings);
  if (detections && detections->timing) update.timings.add(*detections->timing, 1);
  summary.resets += update.counters.reset;
  if (control.on_update) control.on_update(update);
  if (control.on_frame) {
    control.on_frame(
        {.frame = job.frame, .tracked = job.tracked, .dynamic = optimization.dynamic(), .update = update});
  }
}

void complete_summary(const Stages& stages, RunSummary& summary) {
  summary.imu_health = stages.optimization.imu_health();
  summary.detector = stages.detector->description();
  summary.detector_counters = stages.detector->counters();
  if (summary.frames > 0 && summary.skipped.size() == summary.frames) {
    throw InputError("no frame of the sequence could be read; the first error: " +
                     summary.skipped.front().reason);
  }
}

}  // namespace stillpoint
