// SPDX-License-Identifier: BSD-3-Clause
/// Edges of depth images, and the edges of color images that belong to them.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// Where a near surface ends in front of a farther one.
struct DepthEdge {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< between the last pixel of the near side and the next
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< to the far side [1]
  double depth_m = 0.0;                               ///< of the near side
};

/// Edges across rows and columns that are straight over nine pixels, on every twelfth row and column. Between
/// both sides pixels may be missing: the shadow of the projector.
/// @param depth CV_16UC1; 0 = not measured
[[nodiscard]] std::vector<DepthEdge> depth_edges(const cv::Mat& depth, double units_per_m);

/// The nearest edge of an image on the line through a pixel.
/// @param image CV_8UC1
/// @param normal direction of the line; the edge must be perpendicular to it within 30 degrees
/// @return its distance along the normal, at most `radius_px`; nullopt without one
[[nodiscard]] std::optional<double> image_edge(const cv::Mat& image, const Eigen::Vector2d& pixel,
                                               const Eigen::Vector2d& normal, double radius_px);

}  // namespace stillpoint
