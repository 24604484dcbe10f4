// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/playback_detectors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/base/error.h"
#include "core/detector/object_detector.h"

namespace stillpoint {
namespace {

/// The set nearest in time, the earlier one of a tie; null if there are none.
const DetectionSet* nearest(std::span<const DetectionSet> sets, Timestamp t) {
  const auto later = std::lower_bound(sets.begin(), sets.end(), t,
                                      [](const DetectionSet& set, Timestamp stamp) { return set.t < stamp; });
  if (later == sets.end()) return sets.empty() ? nullptr : &sets.back();
  if (later == sets.begin()) return &*later;
  const auto earlier = std::prev(later);
  return seconds_between(earlier->t, t) <= seconds_between(t, later->t) ? &*earlier : &*later;
}

}  // namespace

RecordedDetector::RecordedDetector(std::span<const DetectionSet> sets, double max_time_difference_s)
    : sets_(sets), max_difference_s_(max_time_difference_s) {
  require_increasing(sets, "recorded detections");
  counters_.unrecorded = 0;
}

DetectionSet RecordedDetector::detect(const Frame& frame) {
  const DetectionSet* const found = nearest(sets_, frame.t);
  const bool fits = found != nullptr && std::abs(seconds_between(found->t, frame.t)) <= max_difference_s_;
  if (!fits || found->state != DetectionState::kPresent) {
    ++counters_.skipped;
    if (!fits) ++*counters_.unrecorded;
    return {.t = frame.t, .state = fits ? found->state : DetectionState::kNone, .detections = {}};
  }
  UsableBoxes usable = usable_boxes(found->detections, frame.gray.size());
  counters_.add(usable.counters);
  ++counters_.processed;
  return {.t = frame.t, .state = DetectionState::kPresent, .detections = std::move(usable.detections)};
}

std::string RecordedDetector::description() const {
  return "recorded, " + std::to_string(sets_.size()) + " frames";
}

namespace {

/// Independent random streams.
enum class Stream : std::uint32_t { kMiss = 1, kPhase, kJitter, kFalsePositive };

/// Random numbers as a function of the constructor arguments only. The C++ standard specifies the output of
/// std::seed_seq, so that they are equal on all platforms.
class RandomStream {
 public:
  RandomStream(int seed, Stream stream, const std::string& object, std::int64_t count) {
    std::vector<std::uint32_t> key = {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(stream),
                                      static_cast<std::uint32_t>(count),
                                      static_cast<std::uint32_t>(count >> 32)};
    for (const char letter : object) key.push_back(static_cast<unsigned char>(letter));
    std::seed_seq(key.begin(), key.end()).generate(words_.begin(), words_.end());
  }
  /// In [0, 1); at most eight calls per stream.
  double uniform() {
    STILLPOINT_CHECK(next_ + 2 <= words_.size());
    const std::uint64_t high = words_[next_], low = words_[next_ + 1];
    next_ += 2;
    return static_cast<double>((high << 32 | low) >> 11) * 0x1.0p-53;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Zero mean, unit variance (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::array<std::uint32_t, 16> words_{};
  std::size_t next_ = 0;
};

Box with_jitter(const Box& box, double sigma_px, RandomStream draw) {
  Box result = box;
  for (double* const edge : {&result.x_min, &result.y_min, &result.x_max, &result.y_max}) {
    *edge += sigma_px * draw.normal();
  }
  return result;
}

/// Person at a random position, with a width of 10 to 50 % and a height of 20 to 90 % of the image.
Detection false_positive(RandomStream& draw, cv::Size image) {
  const double width = draw.uniform(0.1, 0.5) * image.width;
  const double height = draw.uniform(0.2, 0.9) * image.height;
  const double x = draw.uniform(0.0, image.width - 1 - width);
  const double y = draw.uniform(0.0, image.height - 1 - height);
  return {.class_name = "person",
          .score = 0.5,
          .box = {.x_min = x, .y_min = y, .x_max = x + width, .y_max = y + height}};
}

}  // namespace

SimulatedDetector::SimulatedDetector(std::span<const DetectionSet> truth, const DetectorConfig& config,
                                     int seed)
    : truth_(truth), config_(config.simulated), seed_(seed) {
  require_increasing(truth, "true boxes");
}

/// The last set up to time `t` plus the timestamp tolerance; null if there is none.
const DetectionSet* SimulatedDetector::newest_at(Timestamp t) const {
  const Timestamp end = after(t, kMaxDetectionOffset_s);
  const auto later = std::upper_bound(truth_.begin(), truth_.end(), end,
                                      [](Timestamp stamp, const DetectionSet& set) { return stamp < set.t; });
  return later == truth_.begin() ? nullptr : &*std::prev(later);
}

bool SimulatedDetector::is_missed(std::int64_t frame_id, const std::string& object) const {
  RandomStream phase(seed_, Stream::kPhase, object, 0);
  const auto offset = static_cast<std::int64_t>(phase.uniform() * config_.burst_frames);
  RandomStream draw(seed_, Stream::kMiss, object, (frame_id + offset) / config_.burst_frames);
  return draw.uniform() < config_.miss_rate;
}

DetectionSet SimulatedDetector::detect(const Frame& frame) {
  const DetectionSet* const truth = newest_at(after(frame.t, -config_.latency_s));
  if (truth == nullptr) {
    ++counters_.skipped;
    return {.t = frame.t, .state = DetectionState::kLate, .detections = {}};
  }
  std::vector<Detection> found;
  std::map<std::string, int> count_of_class;
  for (const Detection& detection : truth->detections) {
    const std::string object =
        detection.class_name + " " + std::to_string(count_of_class[detection.class_name]++);
    if (is_missed(frame.id, object)) continue;
    found.push_back(detection);
    found.back().box =
        with_jitter(detection.box, config_.jitter_px, RandomStream(seed_, Stream::kJitter, object, frame.id));
  }
  RandomStream draw(seed_, Stream::kFalsePositive, "", frame.id);
  if (draw.uniform() < config_.false_positive_rate) found.push_back(false_positive(draw, frame.gray.size()));
  UsableBoxes usable = usable_boxes(std::move(found), frame.gray.size());
  counters_.add(usable.counters);
  ++counters_.processed;
  return {.t = frame.t, .state = DetectionState::kPresent, .detections = std::move(usable.detections)};
}

std::string SimulatedDetector::description() const {
  return "simulated over " + std::to_string(truth_.size()) + " frames of ground truth boxes";
}

}  // namespace stillpoint
