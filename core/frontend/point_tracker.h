// SPDX-License-Identifier: BSD-3-Clause
/// Point tracker selected by the config: OpenCV's pyramidal KLT or 8x8 patches. Paper Sec. III-A.
#pragma once

#include "core/config/frontend_config.h"
#include "core/frontend/klt/klt.h"

namespace stillpoint {

/// The pyramid that `track_points` needs.
/// @param recycled a pyramid that is no longer needed; its memory is reused
[[nodiscard]] ImagePyramid build_pyramid(const FrontendConfig& config, const cv::Mat& gray,
                                         ImagePyramid recycled = {});

/// @param recycled buffers reused for the result
[[nodiscard]] KltResult track_points(const FrontendConfig& config, const TrackingRequest& request,
                                     KltResult recycled = {});

}  // namespace stillpoint
