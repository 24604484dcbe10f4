// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/depth_initialization.h"

#include <cmath>

namespace stillpoint {
namespace {

constexpr double kMaxRelativeSigma = 1.0 / 3.0;

/// When a measured depth agrees with another view, see initialize_depths.
struct DepthGate {
  const DepthConfig& config;
  double bearing_sigma;  ///< [normalized image plane]
  double tolerance;      ///< same

  /// @param error    r: of the reprojection
  /// @param by_depth J: its derivative by the depth
  [[nodiscard]] bool accepts(const Eigen::Vector2d& error, const Eigen::Vector2d& by_depth,
                             double depth) const {
    if (config.agreement_probability <= 0.0) return error.norm() < tolerance;
    const double variance = 2.0 * bearing_sigma * bearing_sigma;
    const double depth_sigma = config.inverse_sigma * depth * depth;
    const Eigen::Matrix2d S =
        variance * Eigen::Matrix2d::Identity() + depth_sigma * depth_sigma * by_depth * by_depth.transpose();
    return error.dot(S.inverse() * error) <= -2.0 * std::log(1.0 - config.agreement_probability);
  }
};

struct MeasuredDepth {
  int frame;
  double depth;  ///< [m]
};

/// Whether some view other than its own agrees with a measured depth.
bool another_view_agrees(const Window& window, const Landmark& landmark, const MeasuredDepth& measured,
                         const DepthGate& gate) {
  const auto [frame, depth] = measured;
  const Eigen::Vector3d ray = landmark.observation_in(frame).bearing.homogeneous();
  for (int other = landmark.host; other <= landmark.last(); ++other) {
    if (other == frame) continue;
    const Pose T_other_frame = window.T_w_c(other).inverse() * window.T_w_c(frame);
    const Eigen::Vector3d p_c = T_other_frame * Eigen::Vector3d(depth * ray);
    if (p_c.z() <= 0.0) continue;
    const Eigen::Vector2d u = p_c.hnormalized();
    const Eigen::Vector3d slope = T_other_frame.q * ray;
    const Eigen::Vector2d by_depth = (slope.head<2>() - u * slope.z()) / p_c.z();
    if (gate.accepts(u - landmark.observation_in(other).bearing, by_depth, depth)) return true;
  }
  return false;
}

/// Mean depth in the host over the measurements in (0, max_m] that another view confirms [m]; 0 if none.
double confirmed_depth(const Window& window, const Landmark& landmark, const DepthGate& gate) {
  const Pose T_chost_w = window.T_w_c(landmark.host).inverse();
  double sum = 0.0;
  int count = 0;
  for (int frame = landmark.host; frame <= landmark.last(); ++frame) {
    const Observation& observation = landmark.observation_in(frame);
    const double measured = observation.depth / window.depth_scale;
    if (measured <= 0.0 || measured > gate.config.max_m) continue;
    const Eigen::Vector3d p_w =
        window.T_w_c(frame) * Eigen::Vector3d(measured * observation.bearing.homogeneous());
    const double depth = (T_chost_w * p_w).z();
    if (depth <= 0.0 || !another_view_agrees(window, landmark, {frame, measured}, gate)) continue;
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
  const DepthGate gate{.config = config.depth,
                       .bearing_sigma = config.feature_sigma_px / focal_px,
                       .tolerance = config.depth.agreement_px / focal_px};
  for (Landmark& landmark : window.landmarks) {
    if (landmark.inverse_depth > 0.0 || landmark.dynamic || landmark.observations.size() < 2) continue;
    double depth = 0.0;
    if (config.depth.usage != DepthUsage::kOff) {
      depth = confirmed_depth(window, landmark, gate);
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
