// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/point_follower.h"

#include <algorithm>
#include <utility>

#include "core/frontend/patch_tracker.h"

namespace stillpoint {

void rebuild_pyramid(const FrontendConfig& config, const cv::Mat& gray, ImagePyramid& pyramid) {
  const int levels = std::max(config.pyramid_levels, config.unpredicted_pyramid_levels);
  if (config.tracker == TrackerKind::kPatch) {
    pyramid.rebuild(gray, kPatchReach, levels, PyramidKind::kPictures);
  } else {
    pyramid.rebuild(gray, config.window_px, levels, PyramidKind::kPicturesAndDerivatives);
  }
}

KltResult follow(const FrontendConfig& config, const ImagePyramid& from, const ImagePyramid& to,
                 const PointSearch& search, KltResult memory) {
  if (config.tracker == TrackerKind::kPatch) {
    return follow_patches(from, to, search.points, search.starts, search.levels,
                          {.max_iterations = config.max_iterations,
                           .min_correlation = static_cast<float>(config.min_correlation)},
                          PatchTarget::kBest, std::move(memory));
  }
  return follow_points(
      from, to, search.points, search.starts,
      {.window_px = config.window_px, .levels = search.levels, .max_iterations = config.max_iterations});
}

}  // namespace stillpoint
