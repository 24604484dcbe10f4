// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/point_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/frontend/patch/patch_tracker.h"
#include "core/frontend/track.h"

namespace stillpoint {
namespace {

constexpr double kMinCosine = 0.1;  // rays more than 84 degrees off the optical axis are not projected

}  // namespace

TrackerPrediction usable_prediction(TrackerPrediction wanted, const MotionPrior& prior) {
  const bool rotation = prior.has_rotation && prior.T_ccur_cprev.q.coeffs().allFinite();
  const bool translation = prior.has_translation && prior.T_ccur_cprev.p.allFinite();
  if (wanted == TrackerPrediction::kNone || !rotation) return TrackerPrediction::kNone;
  return translation ? wanted : TrackerPrediction::kRotation;
}

std::vector<cv::Point2f> predict_pixels(std::span<const Track> tracks, const FeatureMotion& motion,
                                        const Camera& camera, std::vector<cv::Point2f> recycled) {
  const auto& [prior, kind] = motion;
  const Eigen::Matrix3d R_ccur_cprev = prior.T_ccur_cprev.R();
  std::vector<cv::Point2f> pixels = std::move(recycled);
  pixels.clear();
  for (const Track& track : tracks) {
    Eigen::Vector2d pixel = track.feature.pixel;
    if (kind != TrackerPrediction::kNone) {
      Eigen::Vector3d ray_ccur = R_ccur_cprev * track.feature.bearing.homogeneous();
      const bool translate = kind == TrackerPrediction::kFull && track.known_depth > 0.0;
      if (translate) ray_ccur += prior.T_ccur_cprev.p / track.known_depth;
      if (ray_ccur.z() > kMinCosine * ray_ccur.norm()) pixel = camera.project(ray_ccur);
    }
    pixels.push_back(to_point(pixel));
  }
  return pixels;
}

ImagePyramid build_pyramid(const FrontendConfig& config, const cv::Mat& gray, ImagePyramid recycled) {
  ImagePyramid pyramid = std::move(recycled);
  const int levels = std::max(config.pyramid_levels, config.unpredicted_pyramid_levels);
  if (config.tracker == TrackerKind::kPatch) {
    pyramid.rebuild(gray, kPatchReach, levels, PyramidKind::kImages);
  } else {
    pyramid.rebuild(gray, std::max(config.window_px, kPatchReach), levels,
                    PyramidKind::kImagesAndDerivatives);
  }
  return pyramid;
}

KltResult track_points(const FrontendConfig& config, const TrackingRequest& request, KltResult recycled) {
  if (config.tracker == TrackerKind::kPatch) {
    return track_points_patch(request, {.min_correlation = static_cast<float>(config.min_correlation)},
                              PatchTarget::kBest, std::move(recycled));
  }
  return track_points_klt(request, {.window_px = config.window_px});
}

}  // namespace stillpoint
