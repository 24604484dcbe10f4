// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_verification.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"
#include "core/loop/feature_matching.h"
#include "core/loop/relative_pose_estimation.h"

namespace stillpoint {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kMaxSigma_m = 0.05;
constexpr double kMaxSigma_rad = 1.0 * kRadians;
// Errors of depth and calibration are correlated: they do not average out over the inliers, and have no
// effect if both images are taken from the same pose.
constexpr double kMinSigma_m = 0.01;
constexpr double kMinSigma_rad = 0.2 * kRadians;
constexpr double kSigmaPerDistance = 0.03;  // of the translation between the cameras
constexpr double kSigmaPerAngle = 0.02;     // of their rotation

std::vector<PointPair> point_pairs(const Keyframe& query, const Keyframe& match) {
  std::vector<PointPair> pairs;
  for (const FeatureMatch& found : match_features(query.features, match.features)) {
    pairs.push_back({query.features[static_cast<std::size_t>(found.query)].p_c.cast<double>(),
                     match.features[static_cast<std::size_t>(found.match)].p_c.cast<double>()});
  }
  return pairs;
}

/// Standard deviation of the bearings along their shorter axis.
double spread_of(const std::vector<Eigen::Vector2d>& bearings) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& bearing : bearings) mean += bearing;
  mean /= static_cast<double>(bearings.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& bearing : bearings)
    covariance += (bearing - mean) * (bearing - mean).transpose() / static_cast<double>(bearings.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
}

/// The smaller spread of the inliers in the two images.
double min_spread(const std::vector<PointPair>& pairs, const std::vector<int>& inliers) {
  std::vector<Eigen::Vector2d> query;
  std::vector<Eigen::Vector2d> match;
  for (const int i : inliers) {
    const PointPair& pair = pairs[static_cast<std::size_t>(i)];
    query.emplace_back(pair.p_q.hnormalized());
    match.emplace_back(pair.p_m.hnormalized());
  }
  return std::min(spread_of(query), spread_of(match));
}

/// Covariance of A T B, given that of T, with A = T_bm_cm and B = T_cq_bq:
///   d' = R_A d - R_A R [p_B]x theta,   theta' = R_B^T theta
Matrix6 body_covariance(const Pose& A, const EstimatedRelativePose& T, const Pose& B) {
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = A.R();
  J.topRightCorner<3, 3>() = -A.R() * T.T_m_q.R() * skew(B.p);
  J.bottomRightCorner<3, 3>() = B.R().transpose();
  Matrix6 covariance = J * T.covariance * J.transpose();
  const double sigma_m = kMinSigma_m + kSigmaPerDistance * T.T_m_q.p.norm();
  const double sigma_rad =
      kMinSigma_rad + kSigmaPerAngle * T.T_m_q.q.angularDistance(Eigen::Quaterniond::Identity());
  covariance.diagonal().head<3>().array() += sigma_m * sigma_m;
  covariance.diagonal().tail<3>().array() += sigma_rad * sigma_rad;
  return covariance;
}

LoopOutcome assess(const std::vector<PointPair>& pairs, const EstimatedRelativePose& estimate,
                   const LoopConfig& config) {
  const auto inliers = static_cast<double>(estimate.inliers.size());
  if (inliers < config.min_inliers || inliers < config.min_inlier_ratio * static_cast<double>(pairs.size()))
    return LoopOutcome::kFewInliers;
  if (min_spread(pairs, estimate.inliers) < config.min_spread) return LoopOutcome::kSpread;
  const bool certain = largest_sigma(estimate.covariance.topLeftCorner<3, 3>()) < kMaxSigma_m &&
                       largest_sigma(estimate.covariance.bottomRightCorner<3, 3>()) < kMaxSigma_rad;
  return certain ? LoopOutcome::kAccepted : LoopOutcome::kUncertain;
}

}  // namespace

VerifiedLoop verify_loop(const Keyframe& query, const Keyframe& match, const Camera& camera,
                         const LoopConfig& config) {
  VerifiedLoop loop;
  LoopRecord& record = loop.record;
  record = {.query_frame = query.frame, .query_t = query.t, .match_frame = match.frame, .match_t = match.t};
  const std::vector<PointPair> pairs = point_pairs(query, match);
  record.matches = static_cast<int>(pairs.size());
  record.outcome = LoopOutcome::kFewMatches;
  if (record.matches < config.min_inliers) return loop;
  const std::optional<EstimatedRelativePose> estimate =
      estimate_relative_pose(pairs, {.inlier_threshold = config.inlier_px / camera.focal_px(),
                                     .inverse_depth_sigma = config.depth_noise_per_m,
                                     .seed = static_cast<std::uint32_t>(query.frame)});
  record.outcome = LoopOutcome::kFewInliers;
  if (!estimate) return loop;
  record.inliers = static_cast<int>(estimate->inliers.size());
  record.residual_px = estimate->residual * camera.focal_px();
  record.T_match_query = estimate->T_m_q;
  record.outcome = assess(pairs, *estimate, config);
  const Pose T_cq_bq = query.T_b_c.inverse();
  loop.T_bm_bq = match.T_b_c * estimate->T_m_q * T_cq_bq;
  loop.covariance = body_covariance(match.T_b_c, *estimate, T_cq_bq);
  return loop;
}

}  // namespace stillpoint
