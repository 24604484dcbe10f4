// SPDX-License-Identifier: BSD-3-Clause
/// A sequence played forwards and backwards in turn: a long one whose camera never jumps.
#pragma once

#include <memory>

#include "datasets/sensor_stream.h"

namespace stillpoint {

/// Pictures, boxes and true poses go on without a jump in place or time; the picture at a turn is shown once.
/// There are no inertial data: played backwards, an accelerometer would not measure what the true one does.
/// @param passes >= 1; the first is forwards
/// @throws InputError for fewer passes, or a sequence of fewer than two pictures
[[nodiscard]] std::unique_ptr<SensorStream> play_to_and_fro(std::unique_ptr<SensorStream> stream, int passes);

}  // namespace stillpoint
