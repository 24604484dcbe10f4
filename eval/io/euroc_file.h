// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories in the EuRoC MAV CSV format: one row `ns, px, py, pz, qw, qx, qy, qz, ...` per pose.
#pragma once

#include <string>
#include <string_view>

#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// Parses a EuRoC trajectory. Empty lines, lines that begin with '#' and columns after the quaternion
/// (velocity, biases) are ignored.
/// @param name of the file, for error messages
/// @throws InputError with file:line for a malformed row or a stamp that does not increase
[[nodiscard]] LoadedTrajectory parse_euroc(std::string_view text, const std::string& name);

/// The trajectory in this format with 9 decimals, without velocities and biases.
[[nodiscard]] std::string format_euroc(const Trajectory& trajectory);

}  // namespace stillpoint::eval
