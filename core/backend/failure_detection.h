// SPDX-License-Identifier: BSD-3-Clause
/// Detection of a failed state optimization. Qin et al. 2018, Sec. VI-E.
#pragma once

#include "core/types/nav_state.h"

namespace stillpoint {

/// Whether the optimized state is not finite, has an implausible bias (2.5 m/s^2, 1 rad/s), or moved by more
/// than 5 m in one frame; limits of the published code.
/// @param before state of the previous frame
[[nodiscard]] bool has_failed(const NavState& before, const NavState& now);

}  // namespace stillpoint
