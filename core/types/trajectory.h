// SPDX-License-Identifier: BSD-3-Clause
/// Trajectory: a list of timestamped poses of a named coordinate frame.
#pragma once

#include <string>
#include <vector>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

struct StampedPose {
  Timestamp t;
  Pose T_w_f;  ///< pose of frame f (see Trajectory::frame) in the world
};

/// Poses in strictly increasing order of time.
struct Trajectory {
  std::string frame;  ///< e.g. "camera", "imu", "base_link"
  std::vector<StampedPose> poses;
};

}  // namespace stillpoint
