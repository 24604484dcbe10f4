// SPDX-License-Identifier: BSD-3-Clause
/// Faults of single frames: functions from a frame to a frame. Images are copied before they are changed,
/// because copies of a frame share their pixels.
#pragma once

#include "core/types/frame.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// Applies a fault of the targets `kImages` or `kDepth` that needs nothing but the frame: all but frozen,
/// dropped, depth_previous and occluder. The result depends on the fault and the index only.
/// @param frame gray, and color or depth if not empty
/// @param index position of the frame in the sequence
[[nodiscard]] Frame frame_with_fault(Frame frame, const SensorFault& fault, std::size_t index);

}  // namespace stillpoint::datasets
