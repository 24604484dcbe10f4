// SPDX-License-Identifier: BSD-3-Clause
/// Replicates of a recorded sequence: the noise that another exposure of the same scene would have.
#pragma once

#include <memory>

#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// The sequence with normal noise of a standard deviation of one gray level, rounded to whole levels, in each
/// pixel of the gray images; a function of seed, time of the frame and pixel only. Color and depth images
/// stay.
/// @param stream of gray images of 8 bits
/// @param seed >= 0; 0: the stream as it is
[[nodiscard]] std::unique_ptr<SensorStream> with_gray_noise(std::unique_ptr<SensorStream> stream, int seed);

}  // namespace stillpoint::datasets
