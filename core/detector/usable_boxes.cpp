// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/usable_boxes.h"

#include "core/base/error.h"
#include "core/types/box_geometry.h"

namespace stillpoint {

UsableBoxes usable_boxes(std::vector<Detection> detections, cv::Size image_size) {
  const Box image{
      .x_min = 0.0, .y_min = 0.0, .x_max = image_size.width - 1.0, .y_max = image_size.height - 1.0};
  UsableBoxes usable;
  for (Detection& detection : detections) {
    const Box inside = intersection(detection.box, image);
    if (!has_area(detection.box) || !has_area(inside)) {
      ++usable.counters.rejected;
      continue;
    }
    if (inside != detection.box) ++usable.counters.clipped;
    detection.box = inside;
    usable.detections.push_back(std::move(detection));
  }
  usable.counters.boxes = static_cast<std::int64_t>(usable.detections.size());
  return usable;
}

void require_increasing(std::span<const DetectionSet> sets, const std::string& source) {
  for (std::size_t i = 1; i < sets.size(); ++i) {
    if (sets[i].t > sets[i - 1].t) continue;
    throw InputError(source, "set " + std::to_string(i) + " at " + std::to_string(to_seconds(sets[i].t)) +
                                 " s is not later than the previous one; sort the boxes by time");
  }
}

}  // namespace stillpoint
