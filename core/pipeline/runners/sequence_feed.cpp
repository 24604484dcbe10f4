// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/sequence_feed.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/error.h"

namespace stillpoint {
namespace {

void require_order_of_arrivals(const SensorInput& input) {
  const FrameArrival* before = nullptr;
  for (const FrameArrival& arrival : input.arrivals) {
    const bool exists = arrival.index < input.frame_times.size();
    if ((exists && arrival.t < input.frame_times[arrival.index]) ||
        (before != nullptr && arrival.t < before->t)) {
      throw InputError("arrival of frame " + std::to_string(arrival.index),
                       "must not precede its timestamp or the previous arrival");
    }
    before = &arrival;
  }
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

std::unique_ptr<ObjectDetector> make_detector(const SensorInput& input, const OdometryConfig& config) {
  DetectorConfig detector = config.detector;
  detector.kind = used_detector(config);
  const bool simulated = detector.kind == DetectorKind::kSimulated;
  if (simulated && input.true_boxes.empty()) {
    throw InputError(
        "detector.kind",
        "\"simulated\" requires true boxes, which only rendered sequences have (true_boxes.txt); use "
        "\"recorded\", \"network\" or \"none\"");
  }
  return make_object_detector(detector, {.boxes = simulated ? input.true_boxes : input.detections,
                                         .dynamic_classes = config.dynamic.classes,
                                         .seed = config.seed,
                                         .change = input.change_detections});
}

DetectionJob detect_objects(ObjectDetector& detector, const Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  DetectionJob detection{.set = detector.detect(frame), .timing = {}};
  detection.timing = span_since(start, Module::kObjectDetection);
  return detection;
}

ArrivalOrder::ArrivalOrder(const SensorInput& input) {
  require_order_of_arrivals(input);
  if (input.arrivals.empty()) {
    for (std::size_t i = 0; i < input.frame_times.size(); ++i) entering_.push_back({i, input.frame_times[i]});
    return;
  }
  std::vector<bool> enters(input.frame_times.size(), false);
  for (const FrameArrival& arrival : input.arrivals) {
    if (arrival.index >= enters.size()) continue;
    if (!entering_.empty() && arrival.index <= entering_.back().index) continue;
    entering_.push_back(arrival);
    enters[arrival.index] = true;
  }
  for (std::size_t i = 0; i < enters.size(); ++i) {
    if (!enters[i]) skipped_.push_back({i, "arrived after a later frame, or not at all"});
  }
}

std::optional<FrameJob> SequenceFeed::load(std::size_t index) {
  summary_.frames = std::max(summary_.frames, index + 1);
  FrameJob job;
  const auto start = std::chrono::steady_clock::now();
  try {
    job.frame = input_.load_frame(index);
  } catch (const InputError& error) {
    summary_.skipped.push_back({index, error.what()});
    return std::nullopt;
  }
  job.decoding = span_since(start, Module::kImageDecoding);
  return job;
}

std::optional<FrameJob> SequenceFeed::next() {
  while (next_ < order_.count()) {
    if (stop_requested()) return std::nullopt;
    if (std::optional<FrameJob> job = load(order_[next_++].index)) return job;
  }
  return std::nullopt;
}

RunSummary SequenceFeed::completed(const ImuHealth& imu_health, const ObjectDetector& detector) && {
  if (summary_.frames > 0 && summary_.skipped.size() == summary_.frames) {
    throw InputError("no frame of the sequence could be read; the first error: " +
                     summary_.skipped.front().reason);
  }
  summary_.imu_health = imu_health;
  summary_.detector = detector.description();
  summary_.detector_counters = detector.counters();
  return std::move(summary_);
}

}  // namespace stillpoint
