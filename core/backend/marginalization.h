// SPDX-License-Identifier: BSD-3-Clause
/// Takes a frame out of the window and keeps what it said about the others as a prior.
#pragma once

#include "core/backend/backend_config.h"
#include "core/backend/window.h"
#include "core/backend/window_problem.h"

namespace stillpoint {

/// The prior once the oldest frame and the landmarks it hosts are gone. Frame indices are already those after
/// the slide (each one less). The window itself is not changed. Empty where nothing ties that frame to the
/// others.
/// @param focal_px the camera's focal length
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px);

class SchurSolver;

/// The same in memory kept from the last call; the result does not depend on it.
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px, SchurSolver& solver);

/// All blocks that a prior without the oldest frame may speak of: the states after it. Calibration is taken
/// as known: an early, wrong time offset would be frozen into the prior, sure of itself.
[[nodiscard]] std::vector<BlockRef> candidate_blocks(const Window& window);

/// The prior without its say on `frame`; indices above it become one less.
[[nodiscard]] LinearPrior marginalize_frame(const LinearPrior& prior, int frame);

}  // namespace stillpoint
