// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two images by 8x8 patches: an alternative to klt.h. Paper Sec. III-A.
#pragma once

#include "core/frontend/klt/klt.h"
#include "core/frontend/patch/patch_kernel.h"

namespace stillpoint {

/// Finds `points` of image `from` in image `to`; drop-in replacement of `track_points_klt`.
/// @param initial_guesses start of the search in `to`, one per point; the points themselves if unknown
/// @param levels pyramid levels to use, at most those built
/// @param recycled buffers reused for the result
[[nodiscard]] KltResult track_points_patch(const ImagePyramid& from, const ImagePyramid& to,
                                           const std::vector<cv::Point2f>& points,
                                           const std::vector<cv::Point2f>& initial_guesses, int levels,
                                           const PatchSettings& settings,
                                           PatchTarget target = PatchTarget::kBest, KltResult recycled = {});

}  // namespace stillpoint
