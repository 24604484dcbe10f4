// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/drift_correction.h"

#include <Eigen/LU>

#include "core/frontend/track.h"

namespace stillpoint {
namespace {

constexpr float kMaxShift_px = 1.0F;  // tracking from frame to frame is more accurate than that

PatchPoint to_patch_point(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

}  // namespace

void DriftCorrector::rotate(const Eigen::Matrix3d& R_now_before, std::span<Track> tracks) {
  for (Track& track : tracks) track.first_view.R_now_first = R_now_before * track.first_view.R_now_first;
}

/// A_template_image = A_image_template^-1, in pixels.
Eigen::Matrix2d DriftCorrector::warp(const FirstView& first, const Frame& frame,
                                     const Eigen::Vector2d& pixel) const {
  const double depth = sample_depth(frame.depth, frame.depth_units_per_m, pixel, config_.depth_max_spread);
  const double scale = depth > 0.0 && first.depth > 0.0 ? first.depth / depth : 1.0;
  const Eigen::Vector2d ray = camera_.unproject(pixel);
  Eigen::Matrix<double, 2, 3> projection;
  projection << camera_.fx, 0.0, -camera_.fx * ray.x(), 0.0, camera_.fy, -camera_.fy * ray.y();
  const Eigen::Matrix2d A_image_template = scale * projection * first.R_now_first.leftCols<2>() *
                                           Eigen::Vector2d(1.0 / camera_.fx, 1.0 / camera_.fy).asDiagonal();
  return A_image_template.inverse();
}

void DriftCorrector::correct(const Frame& frame, const ImagePyramid& pyramid, std::span<Track> tracks,
                             KltResult& matches) const {
  const AlignmentSettings settings{
      .search = {.min_correlation = static_cast<float>(config_.drift_min_correlation)},
      .max_shift_px = kMaxShift_px};
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    FirstView& first = tracks[i].first_view;
    const cv::Point2f match = matches.pixels[i];
    const Eigen::Vector2d pixel = to_vector(match);
    if (matches.found[i] == 0 || first.patch.empty() || !camera_.contains(pixel, kImageBorder_px)) continue;
    const std::optional<PatchPoint> aligned =
        first.patch.align(pyramid, warp(first, frame, pixel), {match.x, match.y}, settings);
    if (aligned) {
      matches.pixels[i] = {aligned->x, aligned->y};
    } else {
      first.patch.clear();
    }
  }
}

void DriftCorrector::begin_views(const ImagePyramid& pyramid, std::span<Track> tracks) {
  for (Track& track : tracks) {
    FirstView& first = track.first_view;
    if (!first.patch.empty()) continue;
    first.patch.capture(pyramid, to_patch_point(track.feature.pixel));
    first.depth = track.feature.depth;
    first.R_now_first.setIdentity();
  }
}

}  // namespace stillpoint
