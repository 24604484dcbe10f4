// SPDX-License-Identifier: BSD-3-Clause
/// A path as a list of stamped poses, and the name of the frame that moved along it.
#pragma once

#include <string>
#include <vector>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

struct StampedPose {
  Timestamp t;
  Pose T_w_f;  ///< frame f (see Trajectory::frame) in the world
};

/// Poses in strictly rising order of time.
struct Trajectory {
  std::string frame;  ///< e.g. "camera", "imu", "base_link"
  std::vector<StampedPose> poses;
};

}  // namespace stillpoint
