// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories in text formats with one pose per row (s or ns, m):
///   TUM RGB-D benchmark   `t[s] tx ty tz qx qy qz qw`
///   EuRoC MAV CSV         `t[ns], px, py, pz, qw, qx, qy, qz`
/// Lines that begin with '#' and further columns (velocity, biases) are ignored; fields are separated by
/// spaces, tabs or commas; quaternions are normalized.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/fault_log.h"
#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// Contents of a trajectory file.
struct LoadedTrajectory {
  Trajectory trajectory;
  std::size_t skipped_rows = 0;  ///< rows with a value that is not finite or with the quaternion 0 0 0 0
};

/// Reads an estimated trajectory; rows without a pose are skipped and counted.
/// @param file path of the file
/// @param frame name of the body frame of the poses
/// @throws InputError with file:line for a malformed row or a stamp that does not increase; with the file
/// name if it is unreadable or has no poses
[[nodiscard]] LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame = "");

/// The same for a text in memory.
/// @param text contents of the file
/// @param name of the file, for error messages
/// @param frame name of the body frame of the poses
[[nodiscard]] LoadedTrajectory parse_tum(std::string_view text, const std::string& name,
                                         const std::string& frame = "");
[[nodiscard]] LoadedTrajectory parse_euroc(std::string_view text, const std::string& name);

/// Reads the ground truth of a dataset: like `read_tum`, but a row without a pose or with a quaternion whose
/// norm differs from 1 by more than 0.01 is a fault, too.
/// @param file path of the file
/// @param frame name of the body frame of the poses
/// @param faults throws at the first fault, or collects the faults of all rows
[[nodiscard]] Trajectory read_tum_ground_truth(const std::filesystem::path& file, const std::string& frame,
                                               FaultLog& faults);
[[nodiscard]] Trajectory read_euroc_ground_truth(const std::filesystem::path& file, const std::string& frame,
                                                 FaultLog& faults);

/// Writes a TUM trajectory with 9 decimals and a header line with the names of the columns.
/// @throws InputError if the file cannot be written
void write_tum(const Trajectory& trajectory, const std::filesystem::path& file);

/// The text that `write_tum` writes.
[[nodiscard]] std::string format_tum(const Trajectory& trajectory);

/// The trajectory in the EuRoC format with 9 decimals, without velocities and biases.
[[nodiscard]] std::string format_euroc(const Trajectory& trajectory);

}  // namespace stillpoint::eval
