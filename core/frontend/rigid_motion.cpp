// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/rigid_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr std::size_t kSampleSize =
    4;  // one more than the pose needs: it averages, and shuns false solutions
constexpr int kMaxSamples = 100;
constexpr int kSampleSteps = 4;  // from no motion: enough for 30 degrees
constexpr int kRefinementSteps = 4;
constexpr double kUnweighted = 1e3;  // scale of a weight that no misfit lowers
constexpr double kMinDepth = 1e-3;   // [m]: points behind the camera take no part in the refinement

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// One Gauss-Newton step of the left perturbation (theta, p): x' = Exp(theta) x + p.
Pose refine(std::span<const PointObservation> observations, const Pose& T_to_from, double cauchy_scale) {
  Matrix6 H = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p = T_to_from * observation.point;
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
  const Vector6 step = H.ldlt().solve(b);
  if (!step.allFinite()) return T_to_from;
  return Pose{exp_so3(step.head<3>()), step.tail<3>()} * T_to_from;
}

Pose refine(std::span<const PointObservation> observations, Pose T_to_from, double cauchy_scale, int steps) {
  for (int i = 0; i < steps; ++i) T_to_from = refine(observations, T_to_from, cauchy_scale);
  return T_to_from;
}

std::size_t count_inliers(std::span<const PointObservation> observations, const Pose& T_to_from,
                          double threshold) {
  const Eigen::Matrix3d R_to_from = T_to_from.R();
  std::size_t inliers = 0;
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p = R_to_from * observation.point + T_to_from.p;
    const bool fits = (p.head<2>() - p.z() * observation.bearing).norm() <= threshold * p.z();
    inliers += fits ? 1 : 0;
  }
  return inliers;
}

/// Samples to draw until, with the settings' confidence, one was clean. Fischler and Bolles 1981.
double samples_needed(double inlier_share, double confidence) {
  const double clean = std::pow(inlier_share, static_cast<double>(kSampleSize));
  return clean < 1.0 ? std::log(1.0 - confidence) / std::log(1.0 - clean) : 0.0;
}

std::optional<Pose> draw_pose(std::span<const PointObservation> observations,
                              const RigidMotionSettings& settings) {
  const double number = static_cast<double>(observations.size());
  std::minstd_rand random;  // always the same seed: same input, same answer
  Pose best;
  std::size_t most = 0;
  double needed = kMaxSamples;
  for (int i = 0; i < kMaxSamples && i < needed; ++i) {
    std::array<PointObservation, kSampleSize> sample;
    for (PointObservation& one : sample) one = observations[random() % observations.size()];
    const Pose pose = refine(sample, Pose{}, kUnweighted, kSampleSteps);
    const std::size_t inliers = count_inliers(observations, pose, settings.threshold);
    if (inliers <= most) continue;
    best = pose;
    most = inliers;
    needed = samples_needed(static_cast<double>(inliers) / number, settings.confidence);
  }
  if (most < kSampleSize) return std::nullopt;
  return best;
}

}  // namespace

std::optional<Pose> estimate_rigid_motion(std::span<const PointObservation> observations,
                                          const RigidMotionSettings& settings) {
  if (observations.size() < kSampleSize) return std::nullopt;
  const std::optional<Pose> drawn = draw_pose(observations, settings);
  if (!drawn) return std::nullopt;
  return refine(observations, *drawn, 0.5 * settings.threshold, kRefinementSteps);
}

}  // namespace stillpoint
