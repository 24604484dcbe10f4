// SPDX-License-Identifier: BSD-3-Clause
/// Registers depth images of a separate depth camera to the color camera.
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/geometry/camera.h"
#include "datasets/io/sequence_info.h"

namespace stillpoint::datasets {

/// Forward-warps every measured depth pixel (u, v) with depth z into the color camera:
///   p_c = R_c_d z K_d^-1 (u, v, 1)^T + p_c_d,   (u_c, v_c) = project_c(p_c),   z_c = [p_c]_z
/// with a z-buffer. Each depth pixel fills the rectangle between the projections of its corners, so that a
/// color image of higher resolution has no holes.
/// @param depth CV_16UC1 of the depth camera, 0 = not measured
/// @param color the color camera; determines the size of the result
/// @return CV_16UC1, depth along the optical axis of the color camera in the same units, 0 = not measured
[[nodiscard]] cv::Mat register_depth(const cv::Mat& depth, double depth_units_per_m,
                                     const DepthCamera& source, const Camera& color);

}  // namespace stillpoint::datasets
