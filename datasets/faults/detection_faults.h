// SPDX-License-Identifier: BSD-3-Clause
/// Faults of detectors.
#pragma once

#include <opencv2/core/types.hpp>

#include "core/types/detection.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// The result of a detector for one frame, with a fault of target `kDetections`: while it is active, the set
/// becomes `kNone` or `kLate`, or gets `amount` additional boxes of class "person" at random places, each a
/// tenth to a half of the image wide and high. The places depend on the fault and the time only.
/// @param start time of the first frame
[[nodiscard]] DetectionSet detections_with_fault(DetectionSet set, const SensorFault& fault, Timestamp start,
                                                 cv::Size image);

}  // namespace stillpoint::datasets
