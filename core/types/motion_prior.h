// SPDX-License-Identifier: BSD-3-Clause
/// Camera motion between two frames, predicted from inertial data.
#pragma once

#include "core/geometry/pose.h"

namespace stillpoint {

/// Relative motion from the previous camera frame to the current one.
struct MotionPrior {
  Pose T_ccur_cprev;
  bool has_rotation = false;     ///< gyroscope samples cover the interval
  bool has_translation = false;  ///< velocity and gravity are known as well
};

}  // namespace stillpoint
