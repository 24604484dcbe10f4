// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories stored as matrices: KITTI odometry (with a file of time stamps) and 7-Scenes folders.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// KITTI: a line of `poses` is the upper 3x4 part of a pose, row-major; a line of `times` is its stamp [s].
/// @throws InputError with file:line for a malformed row, or if the numbers of rows differ
[[nodiscard]] LoadedTrajectory parse_kitti(std::string_view poses, const std::string& poses_name,
                                           std::string_view times, const std::string& times_name);

/// The two files of a KITTI trajectory.
struct KittiTexts {
  std::string poses;
  std::string times;
};
[[nodiscard]] KittiTexts format_kitti(const Trajectory& trajectory);

/// 7-Scenes: one file `frame-NNNNNN.pose.txt` per frame with a 4x4 camera-to-world matrix. The data set has
/// no time stamps; they are computed as frame number / 30 Hz.
/// @throws InputError for a folder without such files or a malformed file
[[nodiscard]] LoadedTrajectory read_seven_scenes(const std::filesystem::path& folder);

/// Writes `frame-NNNNNN.pose.txt` files; the frame number is round(stamp * 30 Hz).
/// @throws InputError if a file cannot be written or two poses have the same frame number
void write_seven_scenes(const Trajectory& trajectory, const std::filesystem::path& folder);

}  // namespace stillpoint::eval
