// SPDX-License-Identifier: BSD-3-Clause
/// Corners of a keyframe with metric depth and ORB descriptors (Rublee et al. 2011, Sec. 4).
///
/// With an IMU the patch is oriented by gravity instead of its intensity centroid: the pattern is rotated by
/// the image direction of gravity g_c at the bearing (x, y),
///
///   angle = atan2(g_y - y g_z, g_x - x g_z)
///
/// the derivative of the projection of a point that moves along g_c. Unlike the centroid, it has no noise.
#pragma once

#include <vector>

#include "core/config/loop_config.h"
#include "core/geometry/camera.h"
#include "core/loop/keyframe.h"

namespace stillpoint {

/// Describes the static features of the odometry, and up to `loop.max_corners` FAST corners on three image
/// scales, spread over the image. With `loop.exclude_dynamic` none is in a dynamic region or near a dynamic
/// feature. All have a depth between 0.2 m and `loop.max_depth_m` that is measured by consistent pixels.
/// @param keyframe gray and depth image of the size of the camera
[[nodiscard]] std::vector<KeyframeFeature> keyframe_features(const DepartedKeyframe& keyframe,
                                                             const Camera& camera, const LoopConfig& config);

/// Whether a point at this pixel and depth is not to be described, see `loop.exclude_dynamic`.
/// @param depth_m > 0
[[nodiscard]] bool is_dynamic(const DepartedKeyframe& keyframe, const Eigen::Vector2f& pixel, double depth_m,
                              double radius_px);

}  // namespace stillpoint
