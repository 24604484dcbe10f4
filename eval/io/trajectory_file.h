// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories in the text format of the TUM RGB-D benchmark: `t tx ty tz qx qy qz qw` a line, in s and m.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/types/trajectory.h"

namespace stillpoint {

/// What a trajectory file held.
struct LoadedTrajectory {
  Trajectory trajectory;
  std::size_t skipped_rows = 0;  ///< rows that are no pose: a value that is not finite, or quaternion 0 0 0 0
};

/// Reads a TUM trajectory. Lines that begin with '#' and empty lines are comments; fields are separated by
/// spaces, tabs or commas; quaternions are brought to unit length; a pose may be followed by further columns.
/// @param frame name of the frame that the poses are of
/// @throws InputError with file:line on a malformed row, or a stamp that does not rise; with the file on one
/// that is unreadable or holds no pose
[[nodiscard]] LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame = "");

/// `read_tum` on a text already in memory; `name` stands for the file in messages.
[[nodiscard]] LoadedTrajectory parse_tum(std::string_view text, const std::string& name,
                                         const std::string& frame = "");

/// Writes a TUM trajectory with 9 decimals everywhere, after one comment line that names the columns.
/// @throws InputError if the file cannot be written
void write_tum(const Trajectory& trajectory, const std::filesystem::path& file);

/// The text that `write_tum` writes.
[[nodiscard]] std::string format_tum(const Trajectory& trajectory);

}  // namespace stillpoint
