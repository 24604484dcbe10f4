// SPDX-License-Identifier: BSD-3-Clause
/// Pose graph of laps on a circle with known poses, drifting odometry, and loops of which some are false.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/geometry/so3.h"
#include "core/loop/pose_graph.h"

namespace stillpoint {

struct SimulatedPoseGraph {
  PoseGraph graph;
  std::vector<Pose> truth;
  std::vector<bool> true_loops;  ///< of `graph.loops`
};

struct SimulatedGraphOptions {
  int keyframes = 200;
  int keyframes_per_lap = 50;
  int loops = 20;
  int false_every = 0;  ///< each of so many loops is false; 0: none
  double sigma_m = 0.005;
  double sigma_rad = 0.002;  ///< per step of the odometry
  bool gravity = false;
};

inline Eigen::Vector3d normal_vector(std::mt19937& random, double sigma) {
  std::normal_distribution<double> normal(0.0, sigma);
  return {normal(random), normal(random), normal(random)};
}

inline Pose disturbed(const Pose& pose, std::mt19937& random, double sigma_m, double sigma_rad) {
  const Eigen::Vector3d rho = normal_vector(random, sigma_m);
  return {(pose.q * exp_so3(normal_vector(random, sigma_rad))).normalized(), pose.p + rho};
}

/// Steps of 0.2 m, heading along the path, with a changing inclination.
inline Pose pose_on_circle(int keyframe, int keyframes_per_lap) {
  const double angle = 2.0 * std::numbers::pi * keyframe / keyframes_per_lap;
  const double radius = 0.2 * keyframes_per_lap / (2.0 * std::numbers::pi);
  const Eigen::Vector3d p(radius * std::cos(angle), radius * std::sin(angle), 0.1 * std::sin(3.0 * angle));
  const Eigen::Quaterniond heading = exp_so3(Eigen::Vector3d(0.0, 0.0, angle));
  return {heading * exp_so3(Eigen::Vector3d(0.1 * std::sin(5.0 * angle), 0.05, 0.0)), p};
}

/// Covariance of a relative pose, translation first.
inline Matrix6 pose_covariance(double sigma_m, double sigma_rad) {
  Matrix6 matrix = Matrix6::Zero();
  matrix.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return matrix;
}

inline SimulatedPoseGraph simulated_pose_graph(const SimulatedGraphOptions& options) {
  std::mt19937 random(7);
  SimulatedPoseGraph result;
  for (int k = 0; k < options.keyframes; ++k) {
    result.truth.push_back(pose_on_circle(k, options.keyframes_per_lap));
    const Eigen::Vector3d gravity_b = result.truth.back().q.conjugate() * -Eigen::Vector3d::UnitZ();
    result.graph.gravity_b.push_back(options.gravity ? std::optional(gravity_b) : std::nullopt);
  }
  result.graph.T_m_b.push_back(result.truth.front());
  for (int k = 1; k < options.keyframes; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Pose motion = result.truth[at - 1].inverse() * result.truth[at];
    const Pose measured = disturbed(motion, random, options.sigma_m, options.sigma_rad);
    result.graph.odometry.push_back({.i = k - 1,
                                     .j = k,
                                     .T_i_j = measured,
                                     .covariance = pose_covariance(options.sigma_m, options.sigma_rad)});
    result.graph.T_m_b.push_back(result.graph.T_m_b.back() * measured);
  }
  for (int n = 0; n < options.loops; ++n) {
    const int span = options.keyframes - options.keyframes_per_lap;
    const int match = static_cast<int>(static_cast<std::int64_t>(n) * span / options.loops);
    const int query = match + options.keyframes_per_lap;
    const bool is_true = options.false_every == 0 || n % options.false_every != 0;
    Pose T = result.truth[static_cast<std::size_t>(match)].inverse() *
             result.truth[static_cast<std::size_t>(query)];
    if (!is_true) T.p += Eigen::Vector3d(1.5, -0.5, 0.0) + normal_vector(random, 0.5);
    result.graph.loops.push_back({.i = match,
                                  .j = query,
                                  .T_i_j = disturbed(T, random, 0.01, 0.004),
                                  .covariance = pose_covariance(0.01, 0.004)});
    result.true_loops.push_back(is_true);
  }
  return result;
}

/// Largest distance of the poses.
inline double largest_error_m(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  double largest = 0.0;
  for (std::size_t k = 0; k < poses.size(); ++k)
    largest = std::max(largest, (poses[k].p - truth[k].p).norm());
  return largest;
}

}  // namespace stillpoint
