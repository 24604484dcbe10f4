// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two images by 8x8 patches: an alternative to klt.h. Paper Sec. III-A.
#pragma once

#include "core/frontend/klt/klt.h"
#include "core/frontend/patch/patch_kernel.h"

namespace stillpoint {

/// Finds the points by `track_patches`; drop-in replacement of `track_points_klt`.
/// @param recycled buffers reused for the result
[[nodiscard]] KltResult track_points_patch(const TrackingRequest& request, const PatchSettings& settings,
                                           PatchTarget target = PatchTarget::kBest, KltResult recycled = {});

}  // namespace stillpoint
