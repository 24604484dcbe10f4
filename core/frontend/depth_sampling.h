// SPDX-License-Identifier: BSD-3-Clause
/// Depth of a feature from the registered depth picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// Depth at the nearest pixel [m], if the measured depths in the 3x3 pixels around it spread by no more than
/// `max_spread` of it; 0 otherwise, when not measured, or outside the picture. On the edge of an object a
/// corner in the colour picture may carry the depth of what lies before or behind it. The paper is silent.
/// @param depth      CV_16UC1; may be empty: not measured
/// @param max_spread (largest - smallest) / own depth; 0 = no check
[[nodiscard]] double sample_depth(const cv::Mat& depth, double depth_units_per_m,
                                  const Eigen::Vector2d& pixel, double max_spread);

}  // namespace stillpoint
