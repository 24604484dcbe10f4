// SPDX-License-Identifier: BSD-3-Clause
/// Ground truth from text files: TUM rows, EuRoC's state estimate, 4x4 matrices.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/types/trajectory.h"
#include "datasets/fault_log.h"

namespace stillpoint {

/// Reads rows `t tx ty tz qx qy qz qw` (t in seconds, T_w_f); further fields are ignored.
/// @param frame the name of the frame f that the poses are of
/// @throws InputError if the file is missing, unsorted, or a row is not finite or no rotation
[[nodiscard]] Trajectory read_tum_trajectory(const std::filesystem::path& file, const std::string& frame,
                                             FaultLog& faults);

/// Reads EuRoC rows `t [ns], px, py, pz, qw, qx, qy, qz, ...`; otherwise as above.
[[nodiscard]] Trajectory read_euroc_trajectory(const std::filesystem::path& file, const std::string& frame,
                                               FaultLog& faults);

/// Reads the 16 numbers of a rigid transform, row by row.
/// @throws InputError if the file is missing, holds other than 16 finite numbers, or they are no rigid
/// transform
[[nodiscard]] Pose read_pose_matrix(const std::filesystem::path& file);

/// The pose of 16 row-major numbers.
/// @return nothing unless the rotation is orthonormal to 1e-3, right-handed, and the last row is 0 0 0 1
[[nodiscard]] std::optional<Pose> rigid_pose(std::span<const double, 16> row_major);

}  // namespace stillpoint
