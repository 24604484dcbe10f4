// SPDX-License-Identifier: BSD-3-Clause
/// The tracker that the config names: KLT windows by OpenCV or small patches. Paper Sec. III-A.
#pragma once

#include "core/frontend/frontend_config.h"
#include "core/frontend/klt.h"

namespace stillpoint {

/// Points of one picture to find in another.
struct PointSearch {
  const std::vector<cv::Point2f>& points;
  const std::vector<cv::Point2f>& starts;  ///< where to begin, one per point
  int levels;                              ///< of the pyramid
};

/// Makes what `follow` needs of a picture.
void rebuild_pyramid(const FrontendConfig& config, const cv::Mat& gray, ImagePyramid& pyramid);

/// @param memory for the result
[[nodiscard]] KltResult follow(const FrontendConfig& config, const ImagePyramid& from, const ImagePyramid& to,
                               const PointSearch& search, KltResult memory = {});

}  // namespace stillpoint
