// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/depth_initialization.h"

#include <cmath>

namespace stillpoint {
namespace {

constexpr double kMaxRelativeSigma = 1.0 / 3.0;

/// Position of a landmark from the depth measured in one frame.
struct MeasuredPosition {
  Eigen::Vector3d p_w;
  int frame;
};

/// Whether the reprojection error of a position is below `tolerance` in some frame other than its own.
bool another_view_agrees(const Window& window, const Landmark& landmark, const MeasuredPosition& measured,
                         double tolerance) {
  for (int frame = landmark.host; frame <= landmark.last(); ++frame) {
    if (frame == measured.frame) continue;
    const Eigen::Vector3d p_c = window.T_w_c(frame).inverse() * measured.p_w;
    if (p_c.z() > 0.0 && (p_c.hnormalized() - landmark.observation_in(frame).bearing).norm() < tolerance)
      return true;
  }
  return false;
}

/// Mean depth in the host over the measurements in (0, max_m] that another view confirms [m]; 0 if none.
double confirmed_depth(const Window& window, const Landmark& landmark, const DepthConfig& config,
                       double tolerance) {
  const Pose T_chost_w = window.T_w_c(landmark.host).inverse();
  double sum = 0.0;
  int count = 0;
  for (int frame = landmark.host; frame <= landmark.last(); ++frame) {
    const Observation& observation = landmark.observation_in(frame);
    const double measured = observation.depth / window.depth_scale;
    if (measured <= 0.0 || measured > config.max_m) continue;
    const Eigen::Vector3d p_w =
        window.T_w_c(frame) * Eigen::Vector3d(measured * observation.bearing.homogeneous());
    const double depth = (T_chost_w * p_w).z();
    if (depth <= 0.0 || !another_view_agrees(window, landmark, {p_w, frame}, tolerance)) continue;
    sum += depth;
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

double triangulate_depth(const Window& window, const Landmark& landmark, double bearing_sigma) {
  const Eigen::Vector3d ray = landmark.observations.front().bearing.homogeneous();
  const Pose T_w_chost = window.T_w_c(landmark.host);
  double slope_squared = 0.0;
  double slope_offset = 0.0;
  for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
    const Pose T_cj_chost = window.T_w_c(frame).inverse() * T_w_chost;
    const Eigen::Vector3d rotated = T_cj_chost.q * ray;
    const Eigen::Vector2d& bearing = landmark.observation_in(frame).bearing;
    const Eigen::Vector2d slope = rotated.head<2>() - bearing * rotated.z();
    const Eigen::Vector2d offset = T_cj_chost.p.head<2>() - bearing * T_cj_chost.p.z();
    slope_squared += slope.squaredNorm();
    slope_offset += slope.dot(offset);
  }
  if (slope_squared <= 0.0 || bearing_sigma > kMaxRelativeSigma * std::sqrt(slope_squared)) return 0.0;
  const double depth = -slope_offset / slope_squared;
  return depth > 0.0 ? depth : 0.0;
}

void initialize_depths(const BackendConfig& config, double focal_px, Window& window) {
  const double tolerance = config.depth.agreement_px / focal_px;
  for (Landmark& landmark : window.landmarks) {
    if (landmark.inverse_depth > 0.0 || landmark.dynamic || landmark.observations.size() < 2) continue;
    double depth = 0.0;
    if (config.depth.usage != DepthUsage::kOff) {
      depth = confirmed_depth(window, landmark, config.depth, tolerance);
      landmark.source = depth > 0.0 ? DepthSource::kMeasured : DepthSource::kNone;
    }
    if (depth <= 0.0) {
      depth = triangulate_depth(window, landmark, config.feature_sigma_px / focal_px);
      landmark.source = depth > 0.0 ? DepthSource::kTriangulated : DepthSource::kNone;
    }
    if (depth >= config.depth.min_m && depth <= config.depth.max_landmark_depth_m)
      landmark.inverse_depth = 1.0 / depth;
  }
}

}  // namespace stillpoint
