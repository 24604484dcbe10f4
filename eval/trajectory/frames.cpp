// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/frames.h"

namespace stillpoint::eval {

Trajectory move_to_frame(const Trajectory& trajectory, const Pose& T_f_g, const std::string& name) {
  Trajectory moved{.frame = name, .poses = trajectory.poses};
  for (StampedPose& pose : moved.poses) pose.T_w_f = pose.T_w_f * T_f_g;
  return moved;
}

}  // namespace stillpoint::eval
