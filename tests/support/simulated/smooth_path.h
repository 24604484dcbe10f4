// SPDX-License-Identifier: BSD-3-Clause
/// A smooth path with translation and rotation about all axes, for tests of trajectories.
#pragma once

#include <cmath>

#include "core/geometry/so3.h"
#include "core/types/trajectory.h"

namespace stillpoint::test {

/// The pose at `t` [s]: a loop of a few meters, attitudes up to 0.5 rad about all axes.
inline Pose smooth_pose(double t) {
  const Eigen::Vector3d position(2.0 * std::sin(0.4 * t), 1.5 * std::cos(0.3 * t), 0.5 * std::sin(0.7 * t));
  const Eigen::Vector3d attitude(0.3 * std::sin(0.5 * t), 0.4 * std::cos(0.6 * t), 0.5 * std::sin(0.35 * t));
  return Pose{exp_so3(attitude), position};
}

/// `count` poses at intervals of `interval_s`, starting at `begin_s`.
inline Trajectory smooth_path(std::size_t count, double interval_s, double begin_s = 0.0) {
  Trajectory path;
  path.poses.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = begin_s + interval_s * static_cast<double>(i);
    path.poses.push_back({from_seconds(t), smooth_pose(t)});
  }
  return path;
}

}  // namespace stillpoint::test
