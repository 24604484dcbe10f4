// SPDX-License-Identifier: BSD-3-Clause
/// Faults of the transport of frames from the camera.
#pragma once

#include <span>
#include <vector>

#include "core/types/frame.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// Arrivals with a fault of target `kArrival`, which concerns the frames with a timestamp in its active
/// interval:
///
///   frame_late         t <- t + a
///   frame_reordered    with probability a: t <- 1 us after the timestamp of the next frame
///   frame_duplicated   with probability a: also arrives 1 us after the timestamp of the next frame
///
/// a: amount. The last frame of the sequence has no next one and is not changed by the last two.
/// @param arrivals    empty: each frame arrives at its timestamp
/// @param frame_times of the sequence; the first is the start of the schedule
/// @return in order of time
[[nodiscard]] std::vector<FrameArrival> arrivals_with_fault(std::vector<FrameArrival> arrivals,
                                                            const SensorFault& fault,
                                                            std::span<const Timestamp> frame_times);

}  // namespace stillpoint::datasets
