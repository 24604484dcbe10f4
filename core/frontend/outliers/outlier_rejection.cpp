// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/outliers/outlier_rejection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMinMatches = 8;
constexpr std::size_t kSampleSize = 4;  // one more than the minimum averages noise
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

constexpr int kSteps = 4;                    // from the identity; sufficient for 30 degrees
constexpr double kQuadraticLossScale = 1e3;  // Cauchy scale at which all weights are practically 1
constexpr double kMinDepth = 1e-3;           // [m]; points closer or behind the camera are ignored

/// A Gauss-Newton step as in `refine_pose`, but undamped and over (theta, t). The shared one differs in last
/// bits, from which trajectories differ by rounding after two of 84 faults (depth holes, an occluder).
Pose step(std::span<const PointObservation> observations, const Pose& T_to_from, double cauchy_scale) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6 b = Vector6::Zero();
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p = T_to_from * observation.p_w;
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector2d residual = p.hnormalized() - observation.bearing;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0 / p.z(), 0.0, -p.x() / (p.z() * p.z()), 0.0, 1.0 / p.z(), -p.y() / (p.z() * p.z());
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() = -projection * skew(p);
    J.rightCols<3>() = projection;
    const double weight = 1.0 / (1.0 + residual.squaredNorm() / (cauchy_scale * cauchy_scale));
    H += weight * J.transpose() * J;
    b -= weight * J.transpose() * residual;
  }
  const Vector6 change = solve_symmetric(H, b);
  if (!change.allFinite()) return T_to_from;
  return Pose{exp_so3(change.head<3>()), change.tail<3>()} * T_to_from;
}

Pose refine(std::span<const PointObservation> observations, Pose T_to_from, double cauchy_scale) {
  for (int i = 0; i < kSteps; ++i) T_to_from = step(observations, T_to_from, cauchy_scale);
  return T_to_from;
}

std::size_t count_inliers(std::span<const PointObservation> observations, const Pose& T_to_from,
                          double threshold) {
  const Eigen::Matrix3d R_to_from = T_to_from.R();
  std::size_t inliers = 0;
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p = R_to_from * observation.p_w + T_to_from.p;
    const bool fits = (p.head<2>() - p.z() * observation.bearing).norm() <= threshold * p.z();
    inliers += fits ? 1 : 0;
  }
  return inliers;
}

Pose motion_of_sample(std::span<const PointObservation> observations, bool is_large,
                      std::minstd_rand& random) {
  std::array<PointObservation, kSampleSize> sample;
  for (PointObservation& one : sample) one = observations[random() % observations.size()];
  return refine(sample, is_large ? turn_to_bearings({}, sample) : Pose{}, kQuadraticLossScale);
}

/// With 30 % of the points on moving objects, one sample is free of them with a probability of 0.996. As
/// accurate with 8, 30 and 72 on five renderings of market (VO, three starts each, single runs).
constexpr int kMajoritySamples = 20;

/// Scale of the Cauchy loss of a refinement, relative to the inlier threshold. The lower limit is that of an
/// image that is repeated: all errors are 0.
constexpr double kMinScaleRatio = 0.025;
constexpr double kMaxScaleRatio = 0.5;

}  // namespace

std::optional<Pose> estimate_rigid_motion(std::span<const PointObservation> observations,
                                          const RigidMotionSettings& settings) {
  if (observations.size() < kSampleSize) return std::nullopt;
  std::minstd_rand random;  // fixed seed: deterministic
  const auto hypothesis = [&]() -> std::optional<Pose> {
    return motion_of_sample(observations, settings.is_large, random);
  };
  const auto inliers = [&](const Pose& pose) {
    return count_inliers(observations, pose, settings.threshold);
  };
  const PoseConsensus consensus =
      find_consensus(observations.size(),
                     {.max_samples = 100, .sample_size = kSampleSize, .confidence = settings.confidence},
                     hypothesis, inliers);
  if (consensus.inliers < kSampleSize) return std::nullopt;
  return refine(observations, consensus.pose, kMaxScaleRatio * settings.threshold);
}

std::optional<Pose> MajorityMotion::estimate(std::span<const PointObservation> observations,
                                             const RigidMotionSettings& settings) {
  if (observations.size() < kSampleSize) return std::nullopt;
  const double threshold = settings.threshold;
  std::minstd_rand random;  // fixed seed: deterministic
  double least = std::numeric_limits<double>::infinity();
  Pose best;
  for (int i = 0; i < kMajoritySamples; ++i) {
    const Pose T_to_from = motion_of_sample(observations, settings.is_large, random);
    const double median = median_error(observations, T_to_from);
    if (median >= least) continue;
    least = median;
    best = T_to_from;
  }
  if (least > threshold) return std::nullopt;
  const double scale = std::clamp(least, kMinScaleRatio * threshold, kMaxScaleRatio * threshold);
  return refine(observations, best, scale);
}

double MajorityMotion::median_error(std::span<const PointObservation> observations, const Pose& T_to_from) {
  const Eigen::Matrix3d R_to_from = T_to_from.R();
  squared_errors_.clear();
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p = R_to_from * observation.p_w + T_to_from.p;
    squared_errors_.push_back(p.z() > kMinDepth ? (p.hnormalized() - observation.bearing).squaredNorm()
                                                : std::numeric_limits<double>::infinity());
  }
  const auto middle = squared_errors_.begin() + static_cast<std::ptrdiff_t>(squared_errors_.size() / 2);
  std::ranges::nth_element(squared_errors_, middle);
  return std::sqrt(*middle);
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
  const RigidMotionSettings rigid{.threshold = settings.threshold_px / settings.focal_px,
                                  .confidence = settings.confidence,
                                  .is_large = settings.is_large};
  const std::optional<Pose> T_to_from = settings.model == OutlierModel::kMajority
                                            ? majority_motion_.estimate(correspondences_, rigid)
                                            : estimate_rigid_motion(correspondences_, rigid);
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
  has_model_ = matches.size() >= kMinMatches &&
               ((settings.model != OutlierModel::kEpipolar && fit_rigid(matches, settings)) ||
                fit_epipolar(matches, settings));
  if (!has_model_) inliers_.assign(matches.size(), 1);
  return inliers_;
}

}  // namespace stillpoint
