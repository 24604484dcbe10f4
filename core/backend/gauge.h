// SPDX-License-Identifier: BSD-3-Clause
/// Keeps a window without inertial data where it is in the world.
#pragma once

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

/// Undoes a jump of the whole window. Where the oldest pose is and how it is turned is what gone frames say:
/// nothing in the window can know it better. A solve that moves it by a decimetre has met a prior that
/// contradicts itself, baked from a landmark that moved. The window is carried back as one, and the prior
/// begins anew.
/// @param oldest_T_w_b pose of the oldest frame before the solve
/// @return whether there was a jump
bool undo_jump(const Pose& oldest_T_w_b, const InitializerConfig& config, Window& window);

}  // namespace stillpoint
