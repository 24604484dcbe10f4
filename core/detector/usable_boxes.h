// SPDX-License-Identifier: BSD-3-Clause
/// Boxes as detectors hand them out: with area, inside the picture, and counted where they were not.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "core/detector/object_detector.h"

namespace stillpoint {

/// Cuts boxes at the edge of the picture and leaves out those without area in it. Counts both, and the rest.
[[nodiscard]] std::vector<Detection> usable_boxes(std::vector<Detection> detections, cv::Size picture,
                                                  DetectorCounters& counters);

/// @throws InputError naming `place` unless the sets are by strictly rising time
void require_rising(std::span<const DetectionSet> sets, const std::string& place);

}  // namespace stillpoint
