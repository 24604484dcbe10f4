// SPDX-License-Identifier: BSD-3-Clause
/// Validation of detected boxes and detection sets.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "core/detector/object_detector.h"

namespace stillpoint {

struct UsableBoxes {
  std::vector<Detection> detections;
  DetectorCounters counters;  ///< boxes, clipped and rejected
};

/// Clips boxes to the image and removes those without area inside it.
[[nodiscard]] UsableBoxes usable_boxes(std::vector<Detection> detections, cv::Size image_size);

/// @param source name of the sets in error messages
/// @throws InputError if the timestamps are not strictly ascending
void require_increasing(std::span<const DetectionSet> sets, const std::string& source);

}  // namespace stillpoint
