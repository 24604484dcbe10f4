// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/camera_pose.h"

#include <array>
#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Cholesky>

#include "core/config/monitor_config.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr int kMinimalSteps = 5;
constexpr int kRefineSteps = 8;
constexpr int kStepsFromPrediction = 3;

/// Squared bearing error of an observation; infinite behind the camera.
double squared_error(const Pose& T_c_w, const PointObservation& observation) {
  const Eigen::Vector3d p_c = T_c_w * observation.p_w;
  if (p_c.z() < kMonitor.vision.min_depth_m) return std::numeric_limits<double>::infinity();
  return (p_c.hnormalized() - observation.bearing).squaredNorm();
}

/// One Gauss-Newton step on T_c_w, perturbed on the left, with Cauchy weights of scale `scale`.
template <class Observations>
Pose step(const Pose& T_c_w, const Observations& observations, double scale) {
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Identity() * 1e-9;
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p_c = T_c_w * observation.p_w;
    if (p_c.z() < kMonitor.vision.min_depth_m) continue;
    const double inverse_z = 1.0 / p_c.z();
    const Eigen::Vector2d projected = p_c.head<2>() * inverse_z;
    const Eigen::Vector2d error = projected - observation.bearing;
    Eigen::Matrix<double, 2, 3> J_point;
    J_point << inverse_z, 0.0, -projected.x() * inverse_z, 0.0, inverse_z, -projected.y() * inverse_z;
    Eigen::Matrix<double, 2, 6> J;
    J << J_point, -J_point * skew(p_c);
    const double weight = 1.0 / (1.0 + error.squaredNorm() / (scale * scale));
    H.noalias() += weight * J.transpose() * J;
    b.noalias() += weight * J.transpose() * error;
  }
  const Eigen::Matrix<double, 6, 1> change = -H.ldlt().solve(b);
  return Pose{exp_so3(change.tail<3>()), change.head<3>()} * T_c_w;
}

template <class Observations>
Pose refine(Pose T_c_w, const Observations& observations, double scale, int steps) {
  for (int i = 0; i < steps; ++i) T_c_w = step(T_c_w, observations, scale);
  return T_c_w;
}

int count_inliers(const Pose& T_c_w, const std::vector<PointObservation>& observations, double threshold) {
  int inliers = 0;
  for (const PointObservation& observation : observations) {
    inliers += squared_error(T_c_w, observation) < threshold * threshold;
  }
  return inliers;
}

std::array<PointObservation, 4> draw_sample(const std::vector<PointObservation>& observations,
                                            std::mt19937& random) {
  std::array<PointObservation, 4> sample;
  for (PointObservation& drawn : sample) drawn = observations[random() % observations.size()];
  return sample;
}

}  // namespace

Pose product(const Pose& T_a_b, const Pose& T_b_c) {
  Pose (*volatile const product_of_poses)(const Pose&, const Pose&) = &operator*;
  return product_of_poses(T_a_b, T_b_c);
}

std::optional<CameraPose> estimate_camera_pose(const std::vector<PointObservation>& observations,
                                               const Pose& prediction, const CameraPoseOptions& options) {
  if (static_cast<int>(observations.size()) < options.min_inliers) return std::nullopt;

  std::mt19937 random(options.seed);
  const double threshold = options.inlier_threshold;
  const Pose initial = prediction.inverse();
  Pose best = refine(initial, observations, threshold, kRefineSteps);
  int best_inliers = count_inliers(best, observations, threshold);
  for (int i = 0; i < options.iterations; ++i) {
    const Pose hypothesis = refine(initial, draw_sample(observations, random), 1.0, kMinimalSteps);
    const int inliers = count_inliers(hypothesis, observations, threshold);
    if (inliers > best_inliers) {
      best = hypothesis;
      best_inliers = inliers;
    }
  }
  best = refine(best, observations, threshold, kRefineSteps);
  best_inliers = count_inliers(best, observations, threshold);
  if (best_inliers < options.min_inliers || !best.p.allFinite()) return std::nullopt;
  return CameraPose{best.inverse(), best_inliers};
}

std::vector<PointObservation> known_points(const Window& window, const DepthConfig& depth,
                                           std::vector<PointObservation> recycled) {
  std::vector<PointObservation> observations = std::move(recycled);
  observations.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic || landmark.last() != window.newest() || landmark.host == window.newest()) continue;
    const Observation& host = landmark.observations.front();
    const double measured_m = host.depth / window.depth_scale;
    const bool measured = measured_m > 0.0 && measured_m <= depth.max_m;
    double inverse_depth = landmark.inverse_depth;
    if (inverse_depth <= 0.0 && measured) inverse_depth = 1.0 / measured_m;
    if (inverse_depth <= 0.0) continue;
    observations.push_back({window.position(landmark, inverse_depth), landmark.observations.back().bearing});
  }
  return observations;
}

Pose refine_camera_pose(const std::vector<PointObservation>& observations, const Pose& prediction,
                        double inlier_threshold) {
  return refine(prediction.inverse(), observations, inlier_threshold, kStepsFromPrediction).inverse();
}

}  // namespace stillpoint
