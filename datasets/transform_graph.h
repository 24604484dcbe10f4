// SPDX-License-Identifier: BSD-3-Clause
/// Named frames joined by rigid transforms, as robots describe themselves.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/geometry/pose.h"

namespace stillpoint {

/// The pose of `child` in `parent`.
struct NamedTransform {
  std::string parent;
  std::string child;
  Pose T_parent_child;
};

/// Pose of frame `b` in frame `a`, over the fewest links, each walked in either direction.
/// @return nothing if no chain joins the two
[[nodiscard]] std::optional<Pose> find_transform(std::span<const NamedTransform> links, const std::string& a,
                                                 const std::string& b);

}  // namespace stillpoint
