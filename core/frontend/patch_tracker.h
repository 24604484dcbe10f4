// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two pictures by small patches: an alternative to klt.h for the same duty.
/// Paper Sec. III-A.
#pragma once

#include "core/frontend/klt.h"
#include "core/frontend/patch_kernel.h"

namespace stillpoint {

/// Finds `points` of picture `from` in picture `to`, as `follow_points` does; `window_px` is not used.
/// @param guesses where to begin, one per point; the points themselves when nothing is known
/// @param levels pyramid levels to use, at most those built
/// @param memory for the result
[[nodiscard]] KltResult follow_patches(const ImagePyramid& from, const ImagePyramid& to,
                                       const std::vector<cv::Point2f>& points,
                                       const std::vector<cv::Point2f>& guesses, int levels,
                                       const PatchSettings& settings, PatchTarget target = PatchTarget::kBest,
                                       KltResult memory = {});

}  // namespace stillpoint
