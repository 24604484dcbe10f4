// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/relative_pose_estimation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr int kMinInliers = 4;
constexpr int kMaxSamples = 300;
constexpr double kConfidence = 0.999;
constexpr double kDepthSigmas = 3.0;
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
         std::abs(residual.z()) < kDepthSigmas * std::sqrt(2.0) * options.inverse_depth_sigma;
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
  return Pose::from_matrix(Eigen::umeyama(query, match, false));
}

/// Number of samples after which one without outliers was drawn with the required confidence.
int required_samples(std::size_t inliers, std::size_t pairs) {
  const double good = std::pow(static_cast<double>(inliers) / static_cast<double>(pairs), 3);
  if (good >= 1.0 - 1e-9) return 1;
  return static_cast<int>(
      std::min<double>(kMaxSamples, std::ceil(std::log(1.0 - kConfidence) / std::log1p(-good))));
}

Pose best_sample(std::span<const PointPair> pairs, const RelativePoseOptions& options) {
  std::mt19937 random(options.seed);
  Pose best;
  std::size_t most = 0;
  int required = kMaxSamples;
  for (int drawn = 0; drawn < required; ++drawn) {
    const std::array<std::size_t, 3> sample = {random() % pairs.size(), random() % pairs.size(),
                                               random() % pairs.size()};
    if (sample[0] == sample[1] || sample[0] == sample[2] || sample[1] == sample[2]) continue;
    const std::optional<Pose> T_m_q = align(pairs, sample);
    if (!T_m_q) continue;
    const std::size_t inliers = inliers_of(pairs, *T_m_q, options).size();
    if (inliers <= most) continue;
    most = inliers;
    best = *T_m_q;
    required = required_samples(most, pairs.size());
  }
  return best;
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
    Eigen::Matrix3d projection;
    projection << inverse_z, 0.0, -X.x() * inverse_z * inverse_z, 0.0, inverse_z,
        -X.y() * inverse_z * inverse_z, 0.0, 0.0, -inverse_z * inverse_z;
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
    const Eigen::Matrix<double, 6, 1> step = -system.H.ldlt().solve(system.g);
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

}  // namespace stillpoint
