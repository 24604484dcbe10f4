// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/point_tracker.h"

#include <algorithm>
#include <utility>

#include "core/frontend/patch/patch_tracker.h"

namespace stillpoint {

void rebuild_pyramid(const FrontendConfig& config, const cv::Mat& gray, ImagePyramid& pyramid) {
  const int levels = std::max(config.pyramid_levels, config.unpredicted_pyramid_levels);
  if (config.tracker == TrackerKind::kPatch) {
    pyramid.rebuild(gray, kPatchReach, levels, PyramidKind::kImages);
  } else {
    pyramid.rebuild(gray, config.window_px, levels, PyramidKind::kImagesAndDerivatives);
  }
}

KltResult track_points(const FrontendConfig& config, const ImagePyramid& from, const ImagePyramid& to,
                       const TrackingRequest& request, KltResult recycled) {
  if (config.tracker == TrackerKind::kPatch) {
    return track_points_patch(from, to, request.points, request.initial_guesses, request.levels,
                              {.max_iterations = config.max_iterations,
                               .min_correlation = static_cast<float>(config.min_correlation)},
                              PatchTarget::kBest, std::move(recycled));
  }
  return track_points_klt(
      from, to, request.points, request.initial_guesses,
      {.window_px = config.window_px, .levels = request.levels, .max_iterations = config.max_iterations});
}

}  // namespace stillpoint
