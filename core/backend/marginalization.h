// SPDX-License-Identifier: BSD-3-Clause
/// Takes a frame out of the window and keeps what it said about the others as a prior.
#pragma once

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

/// The prior once the oldest frame and the landmarks it hosts are gone. Frame indices are already those after
/// the slide (each one less). The window itself is not changed.
/// @param focal_px the camera's focal length
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px);

/// The prior without its say on `frame`; indices above it become one less.
[[nodiscard]] LinearPrior marginalize_frame(const LinearPrior& prior, int frame);

}  // namespace stillpoint
