// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories stored as matrices: KITTI odometry (with a file of time stamps) and 7-Scenes folders.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// The pose given by a 4x4 matrix in row-major order.
/// @param tolerance of the elements of R R^T and of the last row; the default is far above the rounding of
/// 4-decimal matrices
/// @return nullopt unless the matrix is a rigid transform: R orthonormal and right-handed, last row 0 0 0 1
inline constexpr double kRigidTolerance = 1e-3;
[[nodiscard]] std::optional<Pose> rigid_pose(std::span<const double, 16> row_major,
                                             double tolerance = kRigidTolerance);

/// Reads the 16 numbers of a rigid transform in row-major order.
/// @return nullopt if a number is not finite, for `PoseCheck::kEstimate` only
/// @throws InputError if the file is missing or does not contain a rigid transform
[[nodiscard]] std::optional<Pose> read_pose_matrix(const std::filesystem::path& file, PoseCheck check);

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

/// N of the file name "frame-N" + `suffix`; nullopt for other names.
[[nodiscard]] std::optional<std::int64_t> seven_scenes_number(std::string_view file_name,
                                                              std::string_view suffix);

/// 38 days at 30 Hz: larger numbers in the names of files are times.
inline constexpr std::int64_t kMaxFrameNumber = 100'000'000;

/// Stamp of a frame of data without stamps: number / 30 Hz.
/// @param number at most `kMaxFrameNumber`
[[nodiscard]] Timestamp time_of_frame(std::int64_t number);

/// Writes `frame-NNNNNN.pose.txt` files; the frame number is round(stamp * 30 Hz).
/// @throws InputError if a file cannot be written or two poses have the same frame number
void write_seven_scenes(const Trajectory& trajectory, const std::filesystem::path& folder);

}  // namespace stillpoint::eval
