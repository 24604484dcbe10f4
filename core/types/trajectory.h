// SPDX-License-Identifier: BSD-3-Clause
/// Trajectory: a list of timestamped poses of a named coordinate frame.
#pragma once

#include <string>
#include <vector>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

/// The stamp lies in the padding at the end of the pose: 64 instead of 80 bytes, as files have 10^7 of them.
struct StampedPose {
  StampedPose() = default;
  StampedPose(Timestamp stamp, const Pose& pose) : T_w_f(pose), t(stamp) {}

  [[no_unique_address]] Pose T_w_f;  ///< pose of frame f (see Trajectory::frame) in the world
  Timestamp t;
};
static_assert(sizeof(StampedPose) == sizeof(Pose));

/// Poses in strictly increasing order of time.
struct Trajectory {
  std::string frame;  ///< e.g. "camera", "imu", "base_link"
  std::vector<StampedPose> poses;
};

}  // namespace stillpoint
