// SPDX-License-Identifier: BSD-3-Clause
/// Robust sampling of a registered depth image.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// A depth image registered to the color camera, in raw sensor units.
struct DepthView {
  cv::Mat pixels;  ///< CV_16UC1, 0 = not measured; may be empty
  double units_per_m = 1000.0;
};

/// Largest window of `median_depth`.
inline constexpr int kMaxDepthWindow_px = 31;

/// Median of the valid depths in a square window around a pixel [m]; the upper median for an even count; 0 if
/// the window has no valid depth. The window is clipped to the image.
/// @param depth may be empty, which gives 0
/// @param pixel center of the window, rounded
/// @param window_px side of the window, odd, at most kMaxDepthWindow_px
[[nodiscard]] double median_depth(const DepthView& depth, const Eigen::Vector2d& pixel, int window_px);

}  // namespace stillpoint
