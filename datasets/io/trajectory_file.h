// SPDX-License-Identifier: BSD-3-Clause
/// Ground truth from text files: TUM trajectories, EuRoC state estimates, 4x4 matrices.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/types/trajectory.h"
#include "datasets/io/fault_log.h"

namespace stillpoint::datasets {

/// Reads rows `t tx ty tz qx qy qz qw` (t in seconds, T_w_f); further fields are ignored.
/// @param frame the name of the frame f whose poses are given
/// @throws InputError if the file is missing or unsorted, or a row is not finite or not a unit quaternion
[[nodiscard]] Trajectory read_tum_trajectory(const std::filesystem::path& file, const std::string& frame,
                                             FaultLog& faults);

/// Reads EuRoC rows `t [ns], px, py, pz, qw, qx, qy, qz, ...`; otherwise like `read_tum_trajectory`.
[[nodiscard]] Trajectory read_euroc_trajectory(const std::filesystem::path& file, const std::string& frame,
                                               FaultLog& faults);

/// Reads the 16 numbers of a rigid transform in row-major order.
/// @throws InputError if the file is missing, or does not contain the 16 finite numbers of a rigid transform
[[nodiscard]] Pose read_pose_matrix(const std::filesystem::path& file);

/// The pose given by a 4x4 matrix in row-major order.
/// @return nothing unless the rotation is orthonormal to 1e-3, right-handed, and the last row is 0 0 0 1
[[nodiscard]] std::optional<Pose> rigid_pose(std::span<const double, 16> row_major);

}  // namespace stillpoint::datasets
