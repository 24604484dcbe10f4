// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/detection_faults.h"

#include <cmath>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

constexpr double kScore = 0.9;

Detection false_person(synth::RandomSequence& random, cv::Size image) {
  const double width = image.width * random.uniform(0.1, 0.5);
  const double height = image.height * random.uniform(0.1, 0.5);
  const double x = random.uniform(0.0, image.width - width);
  const double y = random.uniform(0.0, image.height - height);
  return {.class_name = "person",
          .score = kScore,
          .box = {.x_min = x, .y_min = y, .x_max = x + width, .y_max = y + height}};
}

}  // namespace

DetectionSet detections_with_fault(DetectionSet set, const SensorFault& fault, Timestamp start,
                                   cv::Size image) {
  if (!fault.is_active(seconds_between(start, set.t))) return set;
  if (fault.kind != FaultKind::kDetectorHallucinating) {
    const bool late = fault.kind == FaultKind::kDetectorLate;
    return {.t = set.t, .state = late ? DetectionState::kLate : DetectionState::kNone, .detections = {}};
  }
  const auto index = static_cast<std::size_t>(set.t.ns - start.ns);
  synth::RandomSequence random = fault.random(index);
  for (int box = 0; box < static_cast<int>(std::lround(fault.amount)); ++box)
    set.detections.push_back(false_person(random, image));
  return set;
}

}  // namespace stillpoint::datasets
