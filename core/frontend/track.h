// SPDX-License-Identifier: BSD-3-Clause
/// Feature tracks between two frames: their state, their pixels as OpenCV's types, and the depth measured
/// there.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "core/frontend/patch/patch_tracker.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// A feature in the image where its track began, see drift_correction.h.
struct FirstView {
  TrackTemplate patch;
  double depth = 0.0;                                         ///< [m]; 0 = not measured
  Eigen::Matrix3d R_now_first = Eigen::Matrix3d::Identity();  ///< rotation of the camera since
};

struct Track {
  TrackedFeature feature;    ///< observation in the last frame
  double known_depth = 0.0;  ///< last measured depth [m]; 0 = never measured
  /// Observation at the last detection. Outlier rejection compares with it instead of with the last frame, so
  /// that frames without detection leave no interval unchecked; the baseline is longer, too.
  Eigen::Vector2d reference_bearing = Eigen::Vector2d::Zero();
  double reference_depth = 0.0;  ///< depth at the last detection [m]; 0 = not measured
  FirstView first_view;
};

inline cv::Point2f to_point(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

inline Eigen::Vector2d to_vector(const cv::Point2f& point) {
  return {static_cast<double>(point.x), static_cast<double>(point.y)};
}

/// Tracks closer to the edge of the image are lost [px]; as in VINS-Mono.
inline constexpr int kImageBorder_px = 1;

/// @param recycled buffer reused for the result
inline std::vector<cv::Point2f> pixels_of(std::span<const Track> tracks,
                                          std::vector<cv::Point2f> recycled = {}) {
  std::vector<cv::Point2f> pixels = std::move(recycled);
  pixels.clear();
  for (const Track& track : tracks) pixels.push_back(to_point(track.feature.pixel));
  return pixels;
}

/// Depth d at the nearest pixel [m], or 0 if it was not measured, lies outside the image, or lies on a depth
/// discontinuity: (d_max - d_min) / d > `max_spread`, with d_min and d_max over the measured depths of the
/// 3x3 neighborhood. At an object boundary a corner of the color image may get the depth of the foreground
/// or of the background. Not specified by the paper.
/// @param depth      CV_16UC1; empty = not measured
/// @param max_spread 0 = no check
[[nodiscard]] double sample_depth(const cv::Mat& depth, double depth_units_per_m,
                                  const Eigen::Vector2d& pixel, double max_spread);

}  // namespace stillpoint
