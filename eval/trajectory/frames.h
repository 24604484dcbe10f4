// SPDX-License-Identifier: BSD-3-Clause
/// The same motion told of another frame of the robot.
#pragma once

#include <string>

#include "core/types/trajectory.h"

namespace stillpoint {

/// Poses T_w_g from poses T_w_f: the frame g = `name` is fixed to f.
/// @param T_f_g frame g in frame f
[[nodiscard]] Trajectory move_to_frame(const Trajectory& trajectory, const Pose& T_f_g,
                                       const std::string& name);

}  // namespace stillpoint
