// SPDX-License-Identifier: BSD-3-Clause
/// Depth pictures of a camera beside the colour camera, seen from the colour camera.
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"

namespace stillpoint {

/// Where and what the depth camera is.
struct DepthCamera {
  Camera camera;  ///< without distortion
  Pose T_c_d;     ///< depth camera to colour camera
};

/// Moves every measured depth pixel to the pixel of the colour camera that sees the same point; the nearest
/// surface wins. A depth pixel covers the rectangle that its corners map to, so that a denser colour picture
/// gets no pinholes.
/// @param depth CV_16UC1 of the depth camera, 0 = not measured
/// @param color the colour camera; its size is the result's
/// @return CV_16UC1, depth along the colour camera's axis in the same units
[[nodiscard]] cv::Mat register_depth(const cv::Mat& depth, double depth_units_per_m,
                                     const DepthCamera& source, const Camera& color);

}  // namespace stillpoint
