// SPDX-License-Identifier: BSD-3-Clause
/// What the tracker remembers of one feature between two pictures.
#pragma once

#include "core/types/tracked_frame.h"

namespace stillpoint {

struct Track {
  TrackedFeature feature;    ///< as the last picture saw it
  double known_depth = 0.0;  ///< last depth ever measured [m]; 0 = never
  /// Where it was at the last detection: outliers are looked for against that instead of the last picture,
  /// which leaves no interval unchecked when pictures without detection lie between, and gives a longer
  /// baseline.
  Eigen::Vector2d reference_bearing = Eigen::Vector2d::Zero();
  double reference_depth = 0.0;  ///< [m] at that time; 0 = not measured
};

}  // namespace stillpoint
