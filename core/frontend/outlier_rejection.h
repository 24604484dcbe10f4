// SPDX-License-Identifier: BSD-3-Clause
/// Throws out matches that disagree with the epipolar geometry of the two pictures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace stillpoint {

struct OutlierRejectionSettings {
  double threshold_px = 1.0;      ///< distance to the epipolar line, px of the camera's focal length
  double confidence = 0.99;       ///< of having drawn one clean sample
  double min_inlier_share = 0.5;  ///< a model that fewer matches fit is not believed
  double focal_px = 0.0;          ///< > 0
};

/// Which matches fit one fundamental matrix found by RANSAC (Fischler and Bolles 1981; Hartley and Zisserman
/// 2004, Sec. 11.6): 1 = fits. All ones where no judgement is possible: fewer than 8 matches, or no model
/// that `min_inlier_share` of them fit. Under pure rotation or before a plane the matrix is not unique but
/// every such matrix fits the matches, so nothing static is lost. Same input, same answer.
/// @param from, to undistorted normalised coordinates of the same points in two pictures, of equal size
[[nodiscard]] std::vector<std::uint8_t> epipolar_inliers(std::span<const Eigen::Vector2d> from,
                                                         std::span<const Eigen::Vector2d> to,
                                                         const OutlierRejectionSettings& settings);

}  // namespace stillpoint
