// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/point_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/frontend/patch/patch_tracker.h"
#include "core/frontend/track.h"

namespace stillpoint {
namespace {

constexpr double kMinCosine = 0.1;  // rays more than 84 degrees off the optical axis are not projected

/// Patches that are turned by it are still found: on textured planes at least 98 % of them up to 0.33 rad, 16
/// to 94 % from 0.35 to 0.8 rad; from a turned view 88 to 98 %, as it ends at the border of the image.
constexpr double kMaxRoll_rad = 0.35;

/// Rotation about the optical axis, by which patches turn [rad].
double roll(const Eigen::Matrix3d& R_now_before) {
  return std::atan2(R_now_before(1, 0) - R_now_before(0, 1), R_now_before(0, 0) + R_now_before(1, 1));
}

/// What a camera turned by R_turned_camera would have seen from the same place; black where it would have
/// seen more than the image shows.
cv::Mat turn_view(const cv::Mat& gray, const Camera& camera, const Eigen::Matrix3d& R_turned_camera) {
  cv::Mat source(gray.size(), CV_32FC2, cv::Scalar(-1.0, -1.0));
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      const Eigen::Vector2d bearing = camera.unproject({x, y});
      if (!bearing.allFinite()) continue;
      const Eigen::Vector3d ray = R_turned_camera.transpose() * bearing.homogeneous();
      if (ray.z() > kMinCosine * ray.norm()) source.at<cv::Point2f>(y, x) = to_point(camera.project(ray));
    }
  }
  cv::Mat turned;
  cv::remap(gray, turned, source, cv::noArray(), cv::INTER_LINEAR);
  return turned;
}

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

KltResult track_large_motion(const FrontendConfig& config, const Camera& camera, const LargeMotion& motion) {
  const Eigen::Matrix3d R_now_before = motion.T_now_before.R();
  const MotionPrior rotation{.T_ccur_cprev = motion.T_now_before, .has_rotation = true};
  const bool rolls = std::abs(roll(R_now_before)) > kMaxRoll_rad;
  const ImagePyramid before =
      build_pyramid(config, rolls ? turn_view(motion.gray, camera, R_now_before) : motion.gray);
  return track_points(
      config,
      {.from = before,
       .to = motion.now,
       .points = rolls ? predict_pixels(motion.tracks, {rotation, TrackerPrediction::kRotation}, camera)
                       : pixels_of(motion.tracks),
       .initial_guesses = motion.predicted,
       .levels = config.pyramid_levels});
}

KltResult track_points(const FrontendConfig& config, const TrackingRequest& request, KltResult recycled) {
  if (config.tracker == TrackerKind::kPatch) {
    return track_points_patch(request, {.min_correlation = static_cast<float>(config.min_correlation)},
                              PatchTarget::kBest, std::move(recycled));
  }
  return track_points_klt(request, {.window_px = config.window_px});
}

}  // namespace stillpoint
