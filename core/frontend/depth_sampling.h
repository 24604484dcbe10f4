// SPDX-License-Identifier: BSD-3-Clause
/// Depth of a feature from the registered depth image.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// Depth d at the nearest pixel [m], or 0 if it was not measured, lies outside the image, or lies on a depth
/// discontinuity: (d_max - d_min) / d > `max_spread`, with d_min and d_max over the measured depths of the
/// 3x3 neighborhood. At an object boundary a corner of the color image may get the depth of the foreground
/// or of the background. Not specified by the paper.
/// @param depth      CV_16UC1; empty = not measured
/// @param max_spread 0 = no check
[[nodiscard]] double sample_depth(const cv::Mat& depth, double depth_units_per_m,
                                  const Eigen::Vector2d& pixel, double max_spread);

}  // namespace stillpoint
