// SPDX-License-Identifier: BSD-3-Clause
/// Depth interval of the object in a box (`dynamic.mask = "depth_band"`): an alternative to Eq. (2) of Paper
/// Sec. III-C; not part of the paper.
#pragma once

#include <limits>

#include "core/dynamic/depth_view.h"
#include "core/types/detection.h"

namespace stillpoint {

/// Depths in [near_m, far_m) belong to the object.
struct DepthBand {
  double near_m = 0.0;
  double far_m = std::numeric_limits<double>::infinity();
};

/// Interval around the mode of a center-weighted depth histogram.
///
///   h(b)   = sum of exp(-rho_k^2 / (2 * 0.6^2)) over the samples k whose depth lies in bin b
///   b*     = argmax_b h(b)
///   [l, u] = largest run of bins around b* with h(b) >= 0.1 h(b*) and |b - b*| <= ceil(extent_m / 0.1 m)
///   result = [(l - 1) * 0.1 m, (u + 2) * 0.1 m)
///
/// with 24 x 24 samples k on a regular grid over the box, rho_k the distance of a sample from the box center
/// in half side lengths, and bins b of 0.1 m up to 15 m. Unlike Eq. (2) it does not depend on single corner
/// or center pixels, keeps features in front of the object, and finds legs in a box whose center shows the
/// wall between them.
///
/// @param box      with positive area; may exceed the image
/// @param extent_m maximum extent of the object to either side of the mode [m], > 0
/// @return [0, inf) if the box has no valid depth
[[nodiscard]] DepthBand object_depth_band(const DepthView& depth, const Box& box, double extent_m);

}  // namespace stillpoint
