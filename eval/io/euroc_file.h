// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories in the EuRoC MAV csv format: `ns, px, py, pz, qw, qx, qy, qz, ...` a line.
#pragma once

#include <string>
#include <string_view>

#include "eval/io/trajectory_file.h"

namespace stillpoint {

/// Lines that begin with '#' and empty lines are comments; columns after the quaternion (velocity, biases)
/// are passed over. `name` stands for the file in messages.
/// @throws InputError with file:line on a malformed row or a stamp that does not rise
[[nodiscard]] LoadedTrajectory parse_euroc(std::string_view text, const std::string& name);

/// The same path in this format, without velocities and biases; 9 decimals.
[[nodiscard]] std::string format_euroc(const Trajectory& trajectory);

}  // namespace stillpoint
