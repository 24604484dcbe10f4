// SPDX-License-Identifier: BSD-3-Clause
/// Graph of named coordinate frames connected by rigid transforms, like the tf tree of ROS.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/geometry/pose.h"

namespace stillpoint::datasets {

/// The pose of `child` in `parent`.
struct NamedTransform {
  std::string parent;
  std::string child;
  Pose T_parent_child;
};

/// Pose of frame `b` in frame `a` along a path with the fewest links; links are traversed in both directions.
/// @return nothing if the frames are not connected
[[nodiscard]] std::optional<Pose> find_transform(std::span<const NamedTransform> links, const std::string& a,
                                                 const std::string& b);

}  // namespace stillpoint::datasets
