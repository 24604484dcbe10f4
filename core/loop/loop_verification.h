// SPDX-License-Identifier: BSD-3-Clause
/// Geometric verification of a recognized place: correspondences between the features of two keyframes, the
/// relative pose of their cameras from corresponding points, some of them wrong, and what of that is
/// accepted.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/config/loop_config.h"
#include "core/geometry/camera.h"
#include "core/loop/keyframe.h"
#include "core/types/loop_report.h"

namespace stillpoint {

/// Largest reprojection error of an inlier [px]: corners are located to a pixel, on coarse levels of the
/// pyramid to two.
inline constexpr double kLoopInlier_px = 3.0;

/// Standard deviation of an inverse depth [1/m], as of structured light and stereo cameras.
inline constexpr double kLoopInverseDepthSigma = 0.004;

/// Indices of two similar features.
struct FeatureMatch {
  int query = 0;
  int match = 0;
};

/// Pairs of features that are mutually most similar: at most 64 different bits, and less than 0.9 of those of
/// the second-most similar feature of the match, unless that one is the same point (closer than 5 cm).
/// Exhaustive comparison.
[[nodiscard]] std::vector<FeatureMatch> match_features(std::span<const KeyframeFeature> query,
                                                       std::span<const KeyframeFeature> match);

/// A point in the coordinates of both cameras [m].
struct PointPair {
  Eigen::Vector3d p_q = Eigen::Vector3d::Zero();  ///< query
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();  ///< match
};

/// The inlier threshold, in standard deviations of the position of a feature.
constexpr double kThresholdSigmas = 3.0;

struct RelativePoseOptions {
  double inlier_threshold = 0.006;     ///< largest reprojection error on the normalized image plane
  double inverse_depth_sigma = 0.004;  ///< [1/m], of one measurement
  std::uint32_t seed = 1;
};

struct EstimatedRelativePose {
  Pose T_m_q;
  Matrix6 covariance = Matrix6::Zero();  ///< of (p, theta): p + d, q * Exp(theta)
  std::vector<int> inliers;              ///< indices of the pairs
  double residual = 0.0;                 ///< RMS reprojection error of the inliers, normalized image plane
};

/// RANSAC (Fischler and Bolles 1981) over samples of three pairs, aligned in closed form (Umeyama 1991), then
/// Gauss-Newton over the inliers. An inlier reprojects into the match with an error below the threshold, and
/// its depth differs by less than three standard deviations. The refinement minimizes
///
///   sum_k | pi(X_k) - pi(p_m,k) |^2 / s_b^2 + (1 / z(X_k) - 1 / z(p_m,k))^2 / (2 s_d^2),   X_k = T_m_q p_q,k
///
/// with Huber weights, where pi(X) = (x, y) / z, s_b is a third of the threshold, and s_d the
/// inverse depth sigma. The covariance is the inverse of the information at the solution, times the variance
/// of the residuals if that is larger than 1.
/// @return nullopt for fewer than four inliers, or if they do not determine the pose
[[nodiscard]] std::optional<EstimatedRelativePose> estimate_relative_pose(std::span<const PointPair> pairs,
                                                                          const RelativePoseOptions& options);

/// A candidate with its relative pose.
struct VerifiedLoop {
  LoopRecord record;                     ///< `kAccepted` if the geometry is good
  Pose T_bm_bq;                          ///< of the bodies
  Matrix6 covariance = Matrix6::Zero();  ///< of `T_bm_bq`: p + d, q * Exp(theta)
};

/// Matches the features of two keyframes and estimates their relative pose by RANSAC, see
/// `estimate_relative_pose`. Refused are candidates with too few matches or inliers, inliers on a small
/// part of either image, and poses with a standard deviation above 0.05 m or 1 degree. The seed is the frame
/// of the query. The covariance includes 1 cm and 0.2 degrees, 3 % of the translation and 2 % of the
/// rotation, as errors of depth and calibration are correlated.
[[nodiscard]] VerifiedLoop verify_loop(const Keyframe& query, const Keyframe& match, const Camera& camera,
                                       const LoopConfig& config);

}  // namespace stillpoint
