// SPDX-License-Identifier: BSD-3-Clause
/// Reads a trajectory of whatever known format a path holds.
#pragma once

#include <filesystem>
#include <string>

#include "eval/io/trajectory_file.h"

namespace stillpoint {

struct TrajectorySource {
  std::filesystem::path path;
  std::string format;           ///< tum, euroc, kitti, openloris, 7scenes; empty: recognised by content
  std::filesystem::path times;  ///< KITTI's file of times
  int sequence = 0;             ///< of an OpenLORIS file with several; 0: the only one
};

/// Reads by format. A folder is 7-Scenes; a file with a "seq:" line is OpenLORIS; rows of 12 numbers are
/// KITTI; rows whose first field is a whole number of 16 digits or more are EuRoC; other rows are TUM.
/// @throws InputError for unreadable or malformed input, an unknown format, KITTI without times, or several
/// sequences and no choice
[[nodiscard]] LoadedTrajectory read_trajectory(const TrajectorySource& source);

/// The format that the text looks like; "tum" when nothing else fits.
[[nodiscard]] std::string recognise_format(std::string_view text);

}  // namespace stillpoint
