// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_verification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>

#include "core/geometry/covariance.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/pose_from_points.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr int kMaxDistance = 64;       // bits
constexpr double kMaxRatio = 0.9;      // Lowe 2004, Sec. 7.1
constexpr float kSamePoint_m = 0.05F;  // a corner is often found on several image scales

/// The most similar feature, and the distance of the second-most similar that is another point.
struct Nearest {
  int index = -1;
  int distance = std::numeric_limits<int>::max();
  int second = std::numeric_limits<int>::max();
};

Nearest nearest_feature(const KeyframeFeature& feature, std::span<const KeyframeFeature> others) {
  Nearest nearest;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const int distance = hamming_distance(feature.descriptor, others[i].descriptor);
    if (distance < nearest.distance) {
      const bool other_point =
          nearest.index >= 0 &&
          (others[static_cast<std::size_t>(nearest.index)].p_c - others[i].p_c).norm() > kSamePoint_m;
      if (other_point) nearest.second = nearest.distance;
      nearest.index = static_cast<int>(i);
      nearest.distance = distance;
    } else if (distance < nearest.second &&
               (others[static_cast<std::size_t>(nearest.index)].p_c - others[i].p_c).norm() > kSamePoint_m) {
      nearest.second = distance;
    }
  }
  return nearest;
}

}  // namespace

std::vector<FeatureMatch> match_features(std::span<const KeyframeFeature> query,
                                         std::span<const KeyframeFeature> match) {
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < query.size(); ++i) {
    const Nearest nearest = nearest_feature(query[i], match);
    if (nearest.distance > kMaxDistance || nearest.distance > kMaxRatio * nearest.second) continue;
    const Nearest back = nearest_feature(match[static_cast<std::size_t>(nearest.index)], query);
    if (back.index == static_cast<int>(i)) matches.push_back({static_cast<int>(i), nearest.index});
  }
  return matches;
}

namespace {

constexpr int kMinInliers = 4;
constexpr ConsensusOptions kConsensus{.max_samples = 300, .sample_size = 3, .confidence = 0.999};
constexpr int kMaxRefinements = 8;
constexpr double kMinPoint_z = 0.1;   // [m]
constexpr double kMinArea_m2 = 0.01;  // of the triangle of a sample: smaller ones fix no rotation
constexpr double kHuber = 1.5;

/// Residual of a pair: bearing and inverse depth in the match.
Eigen::Vector3d residual_of(const PointPair& pair, const Pose& T_m_q) {
  const Eigen::Vector3d X = T_m_q * pair.p_q;
  Eigen::Vector3d residual;
  residual << X.head<2>() / X.z() - pair.p_m.head<2>() / pair.p_m.z(), 1.0 / X.z() - 1.0 / pair.p_m.z();
  return residual;
}

bool is_inlier(const PointPair& pair, const Pose& T_m_q, const RelativePoseOptions& options) {
  if ((T_m_q * pair.p_q).z() < kMinPoint_z) return false;
  const Eigen::Vector3d residual = residual_of(pair, T_m_q);
  return residual.head<2>().norm() < options.inlier_threshold &&
         std::abs(residual.z()) < kThresholdSigmas * std::sqrt(2.0) * options.inverse_depth_sigma;
}

std::vector<int> inliers_of(std::span<const PointPair> pairs, const Pose& T_m_q,
                            const RelativePoseOptions& options) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (is_inlier(pairs[i], T_m_q, options)) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

std::optional<Pose> align(std::span<const PointPair> pairs, const std::array<std::size_t, 3>& sample) {
  Eigen::Matrix3d query;
  Eigen::Matrix3d match;
  for (int i = 0; i < 3; ++i) {
    const PointPair& pair = pairs[sample[static_cast<std::size_t>(i)]];
    query.col(i) = pair.p_q;
    match.col(i) = pair.p_m;
  }
  const Eigen::Vector3d side = query.col(1) - query.col(0);
  const Eigen::Vector3d other = query.col(2) - query.col(0);
  if (0.5 * side.cross(other).norm() < kMinArea_m2) return std::nullopt;
  const Eigen::Vector3d mean_q = query.rowwise().mean();
  const Eigen::Vector3d mean_m = match.rowwise().mean();
  query.colwise() -= mean_q;
  match.colwise() -= mean_m;
  const Eigen::Quaterniond q_m_q(closest_rotation(match * query.transpose()).R);
  return Pose{q_m_q.normalized(), mean_m - q_m_q * mean_q};
}

Pose best_sample(std::span<const PointPair> pairs, const RelativePoseOptions& options) {
  std::mt19937 random(options.seed);
  const auto hypothesis = [&]() -> std::optional<Pose> {
    const std::array<std::size_t, 3> sample = {random() % pairs.size(), random() % pairs.size(),
                                               random() % pairs.size()};
    if (sample[0] == sample[1] || sample[0] == sample[2] || sample[1] == sample[2]) return std::nullopt;
    return align(pairs, sample);
  };
  const auto inliers = [&](const Pose& T_m_q) { return inliers_of(pairs, T_m_q, options).size(); };
  return find_consensus(pairs.size(), kConsensus, hypothesis, inliers).pose;
}

/// Normal equations of the refinement.
struct System {
  Matrix6 H = Matrix6::Zero();
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  double cost = 0.0;  ///< weighted squared residuals
};

System linearize(std::span<const PointPair> pairs, const std::vector<int>& inliers, const Pose& T_m_q,
                 const RelativePoseOptions& options) {
  const double s_b = options.inlier_threshold / kThresholdSigmas;
  const double s_d = std::sqrt(2.0) * options.inverse_depth_sigma;
  const Eigen::Vector3d inverse_sigmas(1.0 / s_b, 1.0 / s_b, 1.0 / s_d);
  System system;
  for (const int i : inliers) {
    const PointPair& pair = pairs[static_cast<std::size_t>(i)];
    const Eigen::Vector3d X = T_m_q * pair.p_q;
    const double inverse_z = 1.0 / X.z();
    const Eigen::Matrix3d projection = inverse_depth_jacobian(X.head<2>() * inverse_z, inverse_z);
    Eigen::Matrix<double, 3, 6> J;
    J << projection, -projection * T_m_q.R() * skew(pair.p_q);
    J = inverse_sigmas.asDiagonal() * J;
    const Eigen::Vector3d r = inverse_sigmas.cwiseProduct(residual_of(pair, T_m_q));
    const double weight = std::min(1.0, kHuber / std::max(r.norm(), 1e-12));
    system.H += weight * J.transpose() * J;
    system.g += weight * J.transpose() * r;
    system.cost += weight * r.squaredNorm();
  }
  return system;
}

Pose refine(std::span<const PointPair> pairs, const std::vector<int>& inliers, Pose T_m_q,
            const RelativePoseOptions& options) {
  for (int iteration = 0; iteration < kMaxRefinements; ++iteration) {
    const System system = linearize(pairs, inliers, T_m_q, options);
    const Eigen::Matrix<double, 6, 1> step = -solve_symmetric(system.H, system.g);
    if (!step.allFinite()) break;
    T_m_q.p += step.head<3>();
    T_m_q.q = (T_m_q.q * exp_so3(step.tail<3>())).normalized();
    if (step.norm() < 1e-8) break;
  }
  return T_m_q;
}

}  // namespace

std::optional<EstimatedRelativePose> estimate_relative_pose(std::span<const PointPair> pairs,
                                                            const RelativePoseOptions& options) {
  if (pairs.size() < kMinInliers) return std::nullopt;
  EstimatedRelativePose result{.T_m_q = best_sample(pairs, options)};
  for (int round = 0; round < 2; ++round) {
    result.inliers = inliers_of(pairs, result.T_m_q, options);
    if (result.inliers.size() < kMinInliers) return std::nullopt;
    result.T_m_q = refine(pairs, result.inliers, result.T_m_q, options);
  }
  result.inliers = inliers_of(pairs, result.T_m_q, options);
  if (result.inliers.size() < kMinInliers) return std::nullopt;
  const System system = linearize(pairs, result.inliers, result.T_m_q, options);
  const Eigen::LLT<Matrix6> cholesky(system.H);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const double degrees = std::max(1.0, 3.0 * static_cast<double>(result.inliers.size()) - 6.0);
  result.covariance = std::max(1.0, system.cost / degrees) * cholesky.solve(Matrix6::Identity());
  double squared = 0.0;
  for (const int i : result.inliers)
    squared += residual_of(pairs[static_cast<std::size_t>(i)], result.T_m_q).head<2>().squaredNorm();
  result.residual = std::sqrt(squared / static_cast<double>(result.inliers.size()));
  return result;
}

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
constexpr double kMinInlierRatio = 0.35;    // of the matches
// Standard deviation of the inliers along their shorter axis, of the focal length: features in one corner or
// along a line do not determine the pose.
constexpr double kMinSpread = 0.08;

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
  return std::sqrt(std::max(0.0, eigenvalues(covariance)[0]));
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
  Matrix6 covariance = propagate(J, T.covariance);
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
  if (inliers < config.min_inliers || inliers < kMinInlierRatio * static_cast<double>(pairs.size()))
    return LoopOutcome::kFewInliers;
  if (min_spread(pairs, estimate.inliers) < kMinSpread) return LoopOutcome::kSpread;
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
      estimate_relative_pose(pairs, {.inlier_threshold = kLoopInlier_px / camera.focal_px(),
                                     .inverse_depth_sigma = kLoopInverseDepthSigma,
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
