// SPDX-License-Identifier: BSD-3-Clause
/// Reading a registered depth picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// A registered raw depth picture.
struct DepthView {
  cv::Mat pixels;  ///< CV_16UC1, 0 = not measured; may be empty
  double units_per_m = 1000.0;
};

/// Largest window of `robust_depth`.
inline constexpr int kMaxDepthWindow_px = 31;

/// Median of the measured depths in a square window around a pixel, the upper one of an even number [m]; 0
/// where none is measured. The window ends at the edge of the picture.
/// @param window_px side of the window, odd, at most kMaxDepthWindow_px
[[nodiscard]] double robust_depth(const DepthView& depth, const Eigen::Vector2d& pixel, int window_px);

}  // namespace stillpoint
