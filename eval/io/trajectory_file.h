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
#include <vector>

#include "core/base/error.h"
#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// Numbers of rows of a trajectory file that were skipped or moved. The ground truth of TUM fr2 and of EuRoC
/// V1_02 repeats stamps; systems with several threads write poses out of order.
struct RowRepairs {
  std::size_t skipped = 0;    ///< without a pose: a value that is not finite, or the quaternion 0 0 0 0
  std::size_t repeated = 0;   ///< with the stamp of an earlier row, which is used instead
  std::size_t reordered = 0;  ///< up to `kMaxDisorder_s` earlier than a row before them; sorted by time
};

/// Rows that are further from their place by time are an error: the file may contain several runs.
inline constexpr double kMaxDisorder_s = 1.0;

/// One sentence for each kind of repair, without a full stop; empty if there are none.
[[nodiscard]] std::vector<std::string> repair_texts(const RowRepairs& repairs);

/// Contents of a trajectory file.
struct LoadedTrajectory {
  Trajectory trajectory;
  RowRepairs repairs;
};

/// Reads an estimated trajectory. Rows without a pose and rows that repeat a stamp are skipped, rows that are
/// slightly out of order are sorted; all are counted.
/// @param file path of the file
/// @param frame name of the body frame of the poses
/// @throws InputError with file:line for a malformed row or a stamp more than `kMaxDisorder_s` earlier than
/// one before it; with the file name if it is unreadable or has no poses
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
[[nodiscard]] LoadedTrajectory read_tum_ground_truth(const std::filesystem::path& file,
                                                     const std::string& frame, FaultLog& faults);
[[nodiscard]] LoadedTrajectory read_euroc_ground_truth(const std::filesystem::path& file,
                                                       const std::string& frame, FaultLog& faults);

/// Writes a TUM trajectory with 9 decimals and a header line with the names of the columns.
/// @throws InputError if the file cannot be written
void write_tum(const Trajectory& trajectory, const std::filesystem::path& file);

/// The text that `write_tum` writes.
[[nodiscard]] std::string format_tum(const Trajectory& trajectory);

/// The trajectory in the EuRoC format with 9 decimals, without velocities and biases.
[[nodiscard]] std::string format_euroc(const Trajectory& trajectory);

}  // namespace stillpoint::eval
