// SPDX-License-Identifier: BSD-3-Clause
/// Poses of keyframes as parameter blocks of Ceres: (p, q xyzw).
#pragma once

#include <array>

#include "core/geometry/pose.h"

namespace stillpoint {

using PoseBlock = std::array<double, 7>;

inline PoseBlock block_of(const Pose& pose) {
  return {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()};
}

inline Pose pose_of(const PoseBlock& block) {
  return {Eigen::Quaterniond(block.data() + 3).normalized(), Eigen::Vector3d(block.data())};
}

}  // namespace stillpoint
