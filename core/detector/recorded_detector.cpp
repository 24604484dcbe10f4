// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/recorded_detector.h"

#include <algorithm>
#include <cmath>

#include "core/detector/usable_boxes.h"

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

}  // namespace stillpoint
