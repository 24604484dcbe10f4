// SPDX-License-Identifier: BSD-3-Clause
/// Throws out matches that disagree with the motion of the camera between two pictures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/frontend/frontend_config.h"
#include "core/frontend/rigid_motion.h"

namespace stillpoint {

/// One point in two pictures.
struct Match {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< undistorted normalised coordinates in the earlier one
  double depth = 0.0;                              ///< in the earlier one [m]; 0 = not measured
  Eigen::Vector2d to = Eigen::Vector2d::Zero();    ///< undistorted normalised coordinates in the later one
};

/// 1 = fits, 0 = does not, for each match.
using Inliers = std::vector<std::uint8_t>;

struct OutlierRejectionSettings {
  OutlierModel model = OutlierModel::kEpipolar;
  double threshold_px = 1.0;      ///< largest misfit, px of the camera's focal length
  double confidence = 0.99;       ///< of having drawn one clean sample
  double min_inlier_share = 0.5;  ///< a motion that fewer matches fit is not believed
  double focal_px = 0.0;          ///< > 0
};

/// Kept between searches for its memory only.
class OutlierSearch {
 public:
  /// As `find_inliers`. @return valid until the next call
  [[nodiscard]] const Inliers& find(std::span<const Match> matches, const OutlierRejectionSettings& settings);

 private:
  [[nodiscard]] bool fit_epipolar(std::span<const Match> matches, const OutlierRejectionSettings& settings);
  [[nodiscard]] bool fit_rigid(std::span<const Match> matches, const OutlierRejectionSettings& settings);
  [[nodiscard]] bool is_believed(const OutlierRejectionSettings& settings) const;

  std::vector<PointObservation> observations_;
  Inliers inliers_;
};

/// Which matches fit the one motion that most fit, by RANSAC (Fischler and Bolles 1981). Same input, same
/// answer.
///
/// kEpipolar: a fundamental matrix; distance to the epipolar line (Hartley and Zisserman 2004, Sec. 11.6).
/// Under pure rotation or before a plane the matrix is not unique, but every such matrix fits the matches, so
/// nothing static is lost. Movers and false matches along the line are not seen.
///
/// kRigid: a camera pose from the depths of the earlier picture, so that misfits show in both directions and
/// no motion is degenerate; matches without depth are held against its epipolar lines. The step between two
/// pictures is small against the depth: an error of the depth hardly matters. Falls back to kEpipolar where
/// fewer than 20 matches have depth, or the pose is not believed.
///
/// The paper is silent; the published code has the former.
/// @return all ones where no judgement is possible: fewer than 8 matches, or no motion that is believed
[[nodiscard]] Inliers find_inliers(std::span<const Match> matches, const OutlierRejectionSettings& settings);

}  // namespace stillpoint
