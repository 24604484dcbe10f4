// SPDX-License-Identifier: BSD-3-Clause
/// First depth of a landmark: from depth pictures that agree with other views, else from parallax.
#pragma once

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

/// Gives an inverse depth to every landmark that has none and can have one (two observations or more).
///
/// Each measured depth is moved into the host and kept if at least one other view agrees within
/// `agreement_px`; the landmark starts at their mean. Without any agreeing depth it is triangulated where
/// parallax allows, else left out.
void initialize_depths(const BackendConfig& config, double focal_px, Window& window);

/// Depth in the host from parallax alone, by least squares over all observations [m]; 0 if its standard
/// deviation would exceed a third of it or it comes out negative.
/// @param bearing_sigma standard deviation of a bearing [normalised plane]
[[nodiscard]] double triangulate_depth(const Window& window, const Landmark& landmark, double bearing_sigma);

}  // namespace stillpoint
