// SPDX-License-Identifier: BSD-3-Clause
/// Map of a finished run, for relocalization in later ones: keyframes with described points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

/// Binary descriptor of 256 bits.
using Descriptor = std::array<std::uint64_t, 4>;

struct KeyframeFeature {
  Descriptor descriptor{};
  Eigen::Vector3f p_c = Eigen::Vector3f::Zero();  ///< in the camera frame [m], p_c.z() > 0
  std::int64_t track = -1;                        ///< of the odometry; -1: a corner, or of a loaded map
};

/// A keyframe of loop closure.
struct Keyframe {
  std::int64_t frame = 0;
  Timestamp t;
  Pose T_w_b;  ///< by the odometry; in a map: optimized
  Pose T_b_c;
  std::optional<Eigen::Vector3d> gravity_b;  ///< unit vector
  std::vector<KeyframeFeature> features;     ///< the most distinctive corners first
};

struct KeyframeMap {
  std::vector<Keyframe> keyframes;  ///< in the order of the run
};

}  // namespace stillpoint
