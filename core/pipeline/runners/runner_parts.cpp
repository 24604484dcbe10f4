// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/runner_parts.h"

#include <algorithm>
#include <chrono>
#include <utility>

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

LoadedFrame load_frame(const SensorInput& input, std::size_t index) {
  FrameJob job;
  const auto start = std::chrono::steady_clock::now();
  try {
    job.frame = input.load_frame(index);
  } catch (const InputError& error) {
    return {.job = std::nullopt, .error = error.what()};
  }
  job.decoding = span_since(start, Module::kImageDecoding);
  return {.job = std::move(job), .error = {}};
}

std::optional<FrameJob> FrameLoader::next() {
  while (next_ < order_.count()) {
    if (control_.stop_requested && control_.stop_requested()) {
      summary_.interrupted = true;
      return std::nullopt;
    }
    const std::size_t index = order_[next_++].index;
    summary_.frames = index + 1;
    LoadedFrame loaded = load_frame(input_, index);
    if (loaded.job) return std::move(loaded.job);
    summary_.skipped.push_back({index, std::move(loaded.error)});
  }
  return std::nullopt;
}

DetectionJob detect_objects(ObjectDetector& detector, const Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  DetectionJob detection{.set = detector.detect(frame), .timing = {}};
  detection.timing = span_since(start, Module::kObjectDetection);
  return detection;
}

void notify(const RunControl& control, const FrameReport& report) {
  if (control.on_update) control.on_update(report.update);
  if (control.on_frame) control.on_frame(report);
}

RunSummary completed(RunSummary summary, const ImuHealth& imu_health, const ObjectDetector& detector) {
  if (summary.frames > 0 && summary.skipped.size() == summary.frames) {
    throw InputError("no frame of the sequence could be read; the first error: " +
                     summary.skipped.front().reason);
  }
  summary.imu_health = imu_health;
  summary.detector = detector.description();
  summary.detector_counters = detector.counters();
  return summary;
}

}  // namespace stillpoint
