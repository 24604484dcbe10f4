// SPDX-License-Identifier: BSD-3-Clause
/// The depths that an object in a box takes up: our finer answer to the question of Paper Sec. III-C.
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

/// Looks for the depth that most of the box's middle has, and takes in its neighbours as far as they are well
/// filled. One corner or one centre pixel decides nothing, what stands before the object is kept, and a box
/// whose centre shows the wall between two legs still finds the legs.
///
/// @param box      with area; may reach beyond the picture
/// @param extent_m the object reaches at most this far to either side of its most frequent depth, > 0
/// @return everything where nothing in the box was measured
[[nodiscard]] DepthBand object_depth_band(const DepthView& depth, const Box& box, double extent_m);

}  // namespace stillpoint
