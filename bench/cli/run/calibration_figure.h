// SPDX-License-Identifier: BSD-3-Clause
/// The residual fields of `stillpoint calibrate --plot`.
#pragma once

#include "core/calibration/calibrate.h"
#include "core/geometry/camera.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::bench {

/// Mean reprojection error in the cells of a grid over the image, as lines: with the stated calibration, and
/// with that of the other half. What poses and points cannot absorb, as distortion, shows as a pattern; noise
/// does not. Both panels have one scale.
[[nodiscard]] report::Drawing residual_figure(const HeldOutResiduals& residuals, const Camera& camera);

}  // namespace stillpoint::bench
