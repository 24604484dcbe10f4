// SPDX-License-Identifier: BSD-3-Clause
/// Faults of recorded boxes.
#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "core/types/detection.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// Detections with a fault of target `kDetections`: active sets become `kNone` or `kLate`, or get `amount`
/// additional boxes of class "person" at random places, each a tenth to a half of the image wide and high.
/// @param start time of the first frame
[[nodiscard]] std::vector<DetectionSet> detections_with_fault(std::vector<DetectionSet> sets,
                                                              const SensorFault& fault, Timestamp start,
                                                              cv::Size image);

}  // namespace stillpoint::datasets
