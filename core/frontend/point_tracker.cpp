// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/point_tracker.h"

#include <algorithm>
#include <utility>

#include "core/frontend/patch/patch_tracker.h"

namespace stillpoint {

ImagePyramid build_pyramid(const FrontendConfig& config, const cv::Mat& gray, ImagePyramid recycled) {
  ImagePyramid pyramid = std::move(recycled);
  const int levels = std::max(config.pyramid_levels, config.unpredicted_pyramid_levels);
  if (config.tracker == TrackerKind::kPatch) {
    pyramid.rebuild(gray, kPatchReach, levels, PyramidKind::kImages);
  } else {
    pyramid.rebuild(gray, std::max(config.window_px, kPatchReach), levels, PyramidKind::kImagesAndDerivatives);
  }
  return pyramid;
}

KltResult track_points(const FrontendConfig& config, const TrackingRequest& request, KltResult recycled) {
  if (config.tracker == TrackerKind::kPatch) {
    return track_points_patch(request,
                              {.max_iterations = config.max_iterations,
                               .min_correlation = static_cast<float>(config.min_correlation)},
                              PatchTarget::kBest, std::move(recycled));
  }
  return track_points_klt(request, {.window_px = config.window_px, .max_iterations = config.max_iterations});
}

}  // namespace stillpoint
