// SPDX-License-Identifier: BSD-3-Clause
/// The points by which the newest camera is located, see core/geometry/pose_from_points.h.
#pragma once

#include <vector>

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/geometry/pose_from_points.h"

namespace stillpoint {

/// T_a_c = T_a_b T_b_c, by a call of the operator. Inlined, g++ would fuse other products and sums, so that
/// the last bits of a prediction would depend on the sources that are compiled together.
[[nodiscard]] Pose product(const Pose& T_a_b, const Pose& T_b_c);

/// Inlier threshold of camera localization by the window or the map.
inline constexpr double kLocalizationInlier_px = 5.0;

/// Static points observed in the newest frame whose position is known from earlier frames.
/// @param recycled storage for the result; its content is ignored
[[nodiscard]] std::vector<PointObservation> known_points(const Window& window, const DepthConfig& depth,
                                                         std::vector<PointObservation> recycled);

/// Same, static or dynamic, of points that have been observed for 0.2 s: those of a person who just came
/// before the camera are newer.
[[nodiscard]] std::vector<PointObservation> old_points(const Window& window, const DepthConfig& depth,
                                                       std::vector<PointObservation> recycled);

}  // namespace stillpoint
