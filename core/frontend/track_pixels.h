// SPDX-License-Identifier: BSD-3-Clause
/// Pixels of tracks as OpenCV's types.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "core/frontend/track.h"

namespace stillpoint {

inline cv::Point2f to_point(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

inline Eigen::Vector2d to_vector(const cv::Point2f& point) {
  return {static_cast<double>(point.x), static_cast<double>(point.y)};
}

/// @param recycled buffer reused for the result
inline std::vector<cv::Point2f> pixels_of(std::span<const Track> tracks,
                                          std::vector<cv::Point2f> recycled = {}) {
  std::vector<cv::Point2f> pixels = std::move(recycled);
  pixels.clear();
  for (const Track& track : tracks) pixels.push_back(to_point(track.feature.pixel));
  return pixels;
}

}  // namespace stillpoint
