// SPDX-License-Identifier: BSD-3-Clause
/// Change of the body frame of a trajectory.
#pragma once

#include <string>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// T_w_g = T_w_f T_f_g for every pose; f and g are rigidly connected.
/// @param T_f_g pose of frame g in frame f
/// @param name of frame g
[[nodiscard]] Trajectory move_to_frame(const Trajectory& trajectory, const Pose& T_f_g,
                                       const std::string& name);

}  // namespace stillpoint::eval
