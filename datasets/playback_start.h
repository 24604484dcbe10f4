// SPDX-License-Identifier: BSD-3-Clause
/// Plays a sequence from a later time on, as if the recording started there.
#pragma once

#include <memory>

#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// Everything earlier than `start_s` after the first frame is left out: frames, IMU samples, boxes and true
/// poses. The stamps are those of the sequence, frames are numbered from 0.
/// @param stream without injected faults
/// @param start_s >= 0 [s]; 0 or a stream without frames: the stream as it is
/// @throws InputError if no frame is left
[[nodiscard]] std::unique_ptr<SensorStream> start_at(std::unique_ptr<SensorStream> stream, double start_s);

}  // namespace stillpoint::datasets
