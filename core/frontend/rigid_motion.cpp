// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/rigid_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMinObservations = 4;  // P3P and one to choose among its solutions
constexpr int kMaxSamples = 100;
constexpr int kRefinementSteps = 4;
constexpr double kMinDepth = 1e-3;  // [m]: points behind the camera take no part in the refinement

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Pose to_pose(const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  return {exp_so3({rotation[0], rotation[1], rotation[2]}), {translation[0], translation[1], translation[2]}};
}

std::optional<Pose> draw_pose(std::span<const PointObservation> observations,
                              const RigidMotionSettings& settings) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> bearings;
  for (const PointObservation& observation : observations) {
    points.emplace_back(observation.point.x(), observation.point.y(), observation.point.z());
    bearings.emplace_back(observation.bearing.x(), observation.bearing.y());
  }
  constexpr bool kUseGuess = false;
  cv::Vec3d rotation;
  cv::Vec3d translation;
  const bool found = cv::solvePnPRansac(
      points, bearings, cv::Matx33d::eye(), cv::noArray(), rotation, translation, kUseGuess, kMaxSamples,
      static_cast<float>(settings.threshold), settings.confidence, cv::noArray(), cv::SOLVEPNP_P3P);
  if (!found) return std::nullopt;
  const Pose pose = to_pose(rotation, translation);
  if (!pose.q.coeffs().allFinite() || !pose.p.allFinite()) return std::nullopt;
  return pose;
}

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

}  // namespace

std::optional<Pose> estimate_rigid_motion(std::span<const PointObservation> observations,
                                          const RigidMotionSettings& settings) {
  if (observations.size() < kMinObservations) return std::nullopt;
  std::optional<Pose> T_to_from = draw_pose(observations, settings);
  if (!T_to_from) return std::nullopt;
  for (int i = 0; i < kRefinementSteps; ++i) {
    T_to_from = refine(observations, *T_to_from, 0.5 * settings.threshold);
  }
  return T_to_from;
}

}  // namespace stillpoint
