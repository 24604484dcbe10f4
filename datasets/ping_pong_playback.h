// SPDX-License-Identifier: BSD-3-Clause
/// Plays a sequence forwards and backwards alternately: an arbitrarily long sequence with continuous motion.
#pragma once

#include <memory>

#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// Frames, boxes and ground-truth poses continue without a jump in pose or time; the frame at a turning point
/// occurs once. IMU samples are dropped: time-reversed accelerometer samples are not physically valid.
/// @param stream decoded on demand
/// @param passes >= 1; the first is forwards
/// @throws InputError if passes < 1, or the sequence has fewer than two frames
[[nodiscard]] std::unique_ptr<SensorStream> ping_pong_playback(std::unique_ptr<SensorStream> stream,
                                                               int passes);

}  // namespace stillpoint::datasets
