// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/outliers/outlier_rejection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

namespace stillpoint {
namespace {

constexpr std::size_t kMinMatches = 8;
constexpr std::size_t kMinDepthMatches = 20;
constexpr double kMinLineNorm = 1e-12;  // below it, without translation, epipolar lines are undefined

cv::Point2f to_pixel(const Eigen::Vector2d& bearing, double focal_px) {
  return {static_cast<float>(focal_px * bearing.x()), static_cast<float>(focal_px * bearing.y())};
}

/// Distance of a match to the reprojected point or, without depth, to its epipolar line [normalized plane].
double reprojection_error(const Match& match, const Pose& T_to_from) {
  if (match.depth > 0.0) {
    const Eigen::Vector3d p_to = T_to_from * Eigen::Vector3d(match.depth * match.from.homogeneous());
    return p_to.z() > 0.0 ? (p_to.hnormalized() - match.to).norm() : std::numeric_limits<double>::infinity();
  }
  const Eigen::Vector3d ray_from = match.from.homogeneous();
  const Eigen::Vector3d line = T_to_from.p.cross(T_to_from.q * ray_from);
  const double line_norm = line.head<2>().norm();
  return line_norm < kMinLineNorm ? 0.0 : std::abs(line.dot(match.to.homogeneous())) / line_norm;
}

}  // namespace

std::optional<Pose> estimate_rigid_motion(std::span<const PointObservation> observations,
                                          const RigidMotionSettings& settings) {
  constexpr ConsensusOptions kConsensus{.max_samples = 100, .sample_size = 4};
  constexpr PoseRefinement kSampleRefinement{.scale = 1e3, .steps = 4};  // sufficient for 30 degrees
  if (observations.size() < kConsensus.sample_size) return std::nullopt;
  std::minstd_rand random;  // fixed seed: deterministic
  PoseSampling sampling{
      .consensus = kConsensus, .inlier_threshold = settings.threshold, .refinement = kSampleRefinement};
  sampling.consensus.confidence = settings.confidence;
  const PoseConsensus consensus = sample_poses(observations, Pose{}, sampling, std::ref(random));
  if (consensus.inliers < kConsensus.sample_size) return std::nullopt;
  return refine_pose(consensus.pose, observations, {.scale = 0.5 * settings.threshold, .steps = 4});
}

bool OutlierRejector::has_enough_inliers(const OutlierRejectionSettings& settings) const {
  const auto inlier_count = std::count(inliers_.begin(), inliers_.end(), std::uint8_t{1});
  return static_cast<double>(inlier_count) >=
         settings.min_inlier_ratio * static_cast<double>(inliers_.size());
}

bool OutlierRejector::fit_epipolar(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const Match& match : matches) {
    from.push_back(to_pixel(match.from, settings.focal_px));
    to.push_back(to_pixel(match.to, settings.focal_px));
  }
  const cv::Mat matrix =
      cv::findFundamentalMat(from, to, cv::FM_RANSAC, settings.threshold_px, settings.confidence, inliers_);
  return !matrix.empty() && inliers_.size() == matches.size() && has_enough_inliers(settings);
}

bool OutlierRejector::fit_rigid(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  correspondences_.clear();
  for (const Match& match : matches) {
    if (match.depth > 0.0) correspondences_.push_back({match.depth * match.from.homogeneous(), match.to});
  }
  if (correspondences_.size() < kMinDepthMatches) return false;
  const std::optional<Pose> T_to_from = estimate_rigid_motion(
      correspondences_,
      {.threshold = settings.threshold_px / settings.focal_px, .confidence = settings.confidence});
  if (!T_to_from) return false;
  inliers_.clear();
  for (const Match& match : matches) {
    inliers_.push_back(
        reprojection_error(match, *T_to_from) * settings.focal_px <= settings.threshold_px ? 1 : 0);
  }
  if (has_enough_inliers(settings)) motion_ = T_to_from;
  return motion_.has_value();
}

const InlierMask& OutlierRejector::find(std::span<const Match> matches,
                                        const OutlierRejectionSettings& settings) {
  motion_.reset();
  const bool has_model = matches.size() >= kMinMatches &&
                         ((settings.model == OutlierModel::kRigid && fit_rigid(matches, settings)) ||
                          fit_epipolar(matches, settings));
  if (!has_model) inliers_.assign(matches.size(), 1);
  return inliers_;
}

InlierMask find_inliers(std::span<const Match> matches, const OutlierRejectionSettings& settings) {
  return OutlierRejector().find(matches, settings);
}

}  // namespace stillpoint
