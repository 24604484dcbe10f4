// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/outlier_rejection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>

namespace stillpoint {
namespace {

constexpr std::size_t kMinMatches = 8;
constexpr std::size_t kMinDepthMatches = 20;
constexpr double kNoLine = 1e-12;  // without translation there are no epipolar lines to be off

cv::Point2f to_pixel(const Eigen::Vector2d& bearing, double focal_px) {
  return {static_cast<float>(focal_px * bearing.x()), static_cast<float>(focal_px * bearing.y())};
}

/// Distance of a match from where the motion says it should be, or from the line it should be on [normalised
/// plane].
double misfit(const Match& match, const Pose& T_to_from) {
  if (match.depth > 0.0) {
    const Eigen::Vector3d p_to = T_to_from * Eigen::Vector3d(match.depth * match.from.homogeneous());
    return p_to.z() > 0.0 ? (p_to.hnormalized() - match.to).norm() : std::numeric_limits<double>::infinity();
  }
  const Eigen::Vector3d ray_from = match.from.homogeneous();
  const Eigen::Vector3d line = T_to_from.p.cross(T_to_from.q * ray_from);
  const double slope = line.head<2>().norm();
  return slope < kNoLine ? 0.0 : std::abs(line.dot(match.to.homogeneous())) / slope;
}

}  // namespace

bool OutlierSearch::is_believed(const OutlierRejectionSettings& settings) const {
  const auto fitting = std::count(inliers_.begin(), inliers_.end(), std::uint8_t{1});
  return static_cast<double>(fitting) >= settings.min_inlier_share * static_cast<double>(inliers_.size());
}

bool OutlierSearch::fit_epipolar(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const Match& match : matches) {
    from.push_back(to_pixel(match.from, settings.focal_px));
    to.push_back(to_pixel(match.to, settings.focal_px));
  }
  const cv::Mat matrix =
      cv::findFundamentalMat(from, to, cv::FM_RANSAC, settings.threshold_px, settings.confidence, inliers_);
  return !matrix.empty() && inliers_.size() == matches.size() && is_believed(settings);
}

bool OutlierSearch::fit_rigid(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  observations_.clear();
  for (const Match& match : matches) {
    if (match.depth > 0.0) observations_.push_back({match.depth * match.from.homogeneous(), match.to});
  }
  if (observations_.size() < kMinDepthMatches) return false;
  const std::optional<Pose> T_to_from = estimate_rigid_motion(
      observations_,
      {.threshold = settings.threshold_px / settings.focal_px, .confidence = settings.confidence});
  if (!T_to_from) return false;
  inliers_.clear();
  for (const Match& match : matches) {
    inliers_.push_back(misfit(match, *T_to_from) * settings.focal_px <= settings.threshold_px ? 1 : 0);
  }
  return is_believed(settings);
}

const Inliers& OutlierSearch::find(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  const bool judged = matches.size() >= kMinMatches &&
                      ((settings.model == OutlierModel::kRigid && fit_rigid(matches, settings)) ||
                       fit_epipolar(matches, settings));
  if (!judged) inliers_.assign(matches.size(), 1);
  return inliers_;
}

Inliers find_inliers(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  return OutlierSearch().find(matches, settings);
}

}  // namespace stillpoint
