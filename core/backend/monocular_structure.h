// SPDX-License-Identifier: BSD-3-Clause
/// Structure from motion over the window of one camera without depth. Qin et al. 2018 (VINS-Mono), Sec. V-A.
#pragma once

#include <optional>

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

/// Places all cameras and the landmarks with parallax, up to one scale: the median depth is about 1.
///
/// The first frame that shares enough features and parallax with the newest gives their relative pose by the
/// five-point algorithm; points of the two locate the frames between them, then the older ones; all is
/// refined together. Gyroscopes take the rotation out of the parallax and predict it for the search, no more.
/// @param window every frame but the first with inertial samples; its poses and depths are not used
/// @param focal_px the camera's focal length, by which pixels become bearings
/// @return the window in the world of that first frame's camera; nothing where parallax does not suffice
[[nodiscard]] std::optional<Window> reconstruct_window(const Window& window, const BackendConfig& config,
                                                       double focal_px);

}  // namespace stillpoint
