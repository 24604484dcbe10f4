// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories as rows of matrices: KITTI odometry (with a file of times) and 7-Scenes folders.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "eval/io/trajectory_file.h"

namespace stillpoint {

/// KITTI: a line is the upper 3x4 of the pose, row-major; `times` has one number of seconds a line.
/// @throws InputError with file:line on a row that is no pose, or when the counts differ
[[nodiscard]] LoadedTrajectory parse_kitti(std::string_view poses, const std::string& poses_name,
                                           std::string_view times, const std::string& times_name);

/// The poses and the times of a path as KITTI texts.
struct KittiTexts {
  std::string poses;
  std::string times;
};
[[nodiscard]] KittiTexts format_kitti(const Trajectory& trajectory);

/// 7-Scenes: `frame-NNNNNN.pose.txt`, each a 4x4 camera-to-world matrix. The data set has no stamps: frame
/// number / 30 s.
/// @throws InputError for a folder without such files or a file that holds no pose
[[nodiscard]] LoadedTrajectory read_seven_scenes(const std::filesystem::path& folder);

/// Writes `frame-NNNNNN.pose.txt` files, the number being the stamp times 30, rounded.
/// @throws InputError if a file cannot be written or two poses have one frame number
void write_seven_scenes(const Trajectory& trajectory, const std::filesystem::path& folder);

}  // namespace stillpoint
