// SPDX-License-Identifier: BSD-3-Clause
/// Timestamps of the images of a rendered sequence: at equal intervals, or those of a recording.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/timestamp.h"

namespace stillpoint::synth {

/// One entry per frame; the depth image of a frame shows the scene at the time of its color image.
struct FrameTimes {
  std::vector<Timestamp> color;  ///< increasing
  std::vector<Timestamp> depth;  ///< equal to `color` unless recorded
};

/// Times of a recording with the frames that it lost. A line has the time of the color image [s], and may
/// have that of the depth image in its third field, as written by the association script of TUM RGB-D; the
/// other fields are names of files. Lines that begin with # are skipped.
/// @param file the recording @param seconds duration from the first frame on
/// @return in whole microseconds
/// @throws InputError with file:line if a time cannot be read or does not increase, and if there is no frame
[[nodiscard]] FrameTimes load_recorded_times(const std::filesystem::path& file, double seconds);

}  // namespace stillpoint::synth
