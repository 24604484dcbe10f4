// SPDX-License-Identifier: BSD-3-Clause
/// Point tracker selected by the config: OpenCV's pyramidal KLT or 8x8 patches. Paper Sec. III-A.
#pragma once

#include "core/config/frontend_config.h"
#include "core/frontend/klt/klt.h"

namespace stillpoint {

/// Points of one image to find in another.
struct TrackingRequest {
  const std::vector<cv::Point2f>& points;
  const std::vector<cv::Point2f>& initial_guesses;  ///< in the other image, one per point
  int levels;                                       ///< pyramid levels to use
};

/// Builds the pyramid that `track_points` needs.
void rebuild_pyramid(const FrontendConfig& config, const cv::Mat& gray, ImagePyramid& pyramid);

/// @param recycled buffers reused for the result
[[nodiscard]] KltResult track_points(const FrontendConfig& config, const ImagePyramid& from,
                                     const ImagePyramid& to, const TrackingRequest& request,
                                     KltResult recycled = {});

}  // namespace stillpoint
