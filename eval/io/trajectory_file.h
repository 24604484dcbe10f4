// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories in the text format of the TUM RGB-D benchmark: rows `t tx ty tz qx qy qz qw` in s and m.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// Contents of a trajectory file.
struct LoadedTrajectory {
  Trajectory trajectory;
  std::size_t skipped_rows = 0;  ///< rows with a value that is not finite or with the quaternion 0 0 0 0
};

/// Reads a TUM trajectory. Empty lines and lines that begin with '#' are ignored; fields are separated by
/// spaces, tabs or commas; quaternions are normalized; columns after the pose are ignored.
/// @param frame name of the body frame of the poses
/// @throws InputError with file:line for a malformed row or a stamp that does not increase; with the file
/// name if it is unreadable or has no poses
[[nodiscard]] LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame = "");

/// `read_tum` for a text in memory.
/// @param name of the file, for error messages
[[nodiscard]] LoadedTrajectory parse_tum(std::string_view text, const std::string& name,
                                         const std::string& frame = "");

/// Writes a TUM trajectory with 9 decimals and a header line with the names of the columns.
/// @throws InputError if the file cannot be written
void write_tum(const Trajectory& trajectory, const std::filesystem::path& file);

/// The text that `write_tum` writes.
[[nodiscard]] std::string format_tum(const Trajectory& trajectory);

}  // namespace stillpoint::eval
