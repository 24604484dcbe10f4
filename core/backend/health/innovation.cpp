// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/innovation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

const double kMedianOfChiSquare2 = 2.0 * std::log(2.0);

}  // namespace

std::optional<double> reprojection_nis(const Window& window, const UncertainPose& camera,
                                       double residual_sigma, std::vector<double>& distances) {
  const Pose T_c_w = camera.T_w_f.inverse();
  distances.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic || landmark.last() != window.newest() || landmark.host == window.newest() ||
        landmark.inverse_depth <= 0.0) {
      continue;
    }
    const Eigen::Vector3d p_c = T_c_w * window.position(landmark, landmark.inverse_depth);
    if (p_c.z() < kMonitor.vision.min_depth_m) continue;
    const Eigen::Vector2d v = landmark.observations.back().bearing - p_c.hnormalized();
    const Eigen::Matrix2d S =
        projection_covariance(camera, p_c) + residual_sigma * residual_sigma * Eigen::Matrix2d::Identity();
    distances.push_back(v.dot(S.inverse() * v));
  }
  if (static_cast<int>(distances.size()) < kMonitor.innovation.min_landmarks) return std::nullopt;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  return *middle / kMedianOfChiSquare2;
}

double inertial_nis(const UncertainPose& predicted, const UncertainPose& visual) {
  return squared_distance(predicted.T_w_f, visual.T_w_f, predicted.covariance + visual.covariance) / 6.0;
}

}  // namespace stillpoint
