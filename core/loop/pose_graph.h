// SPDX-License-Identifier: BSD-3-Clause
/// Pose graph: positions and attitudes of all keyframes from the motion between successive ones, loops, and
/// the direction of gravity.
///
/// The minimum over the poses T_m_b, and over the direction of gravity g in the map, of
///
///   sum_odometry |r|^2 + sum_gravity |r|^2 + sum_loops min(|r|^2, c^2)
///
/// with the residuals of pose_graph_factors.h. The loops have truncated quadratic costs, solved by graduated
/// non-convexity (Yang et al. 2020, Sec. IV): a sequence of weighted least squares problems with growing mu.
/// Weights by the Black-Rangarajan duality, Eq. (14):
///
///   w = 1                                if r^2 <= mu / (mu + 1) c^2
///   w = c / |r| sqrt(mu (mu + 1)) - mu   between
///   w = 0                                if r^2 >= (mu + 1) / mu c^2
///
/// starting at mu = c^2 / (2 r_max^2 - c^2) (Remark 5), where all weights are positive.
#pragma once

#include <optional>
#include <vector>

#include "core/loop/keyframe.h"

namespace stillpoint {

/// Measured relative pose.
struct GraphEdge {
  int i = 0;
  int j = 0;
  Pose T_i_j;
  Matrix6 covariance = Matrix6::Identity();  ///< p + rho, q * Exp(theta); positive definite
};

struct PoseGraph {
  std::vector<Pose> T_m_b;                                ///< initial poses; the first one is constant
  std::vector<std::optional<Eigen::Vector3d>> gravity_b;  ///< measured directions, one entry per pose
  std::vector<GraphEdge> odometry;
  std::vector<GraphEdge> loops;
};

struct PoseGraphOptions {
  int dof = 6;  ///< 4: attitudes change about the vertical only; needs gravity in all poses
  double gravity_sigma_rad = 0.005;
  double max_loop_chi2 = 22.5;  ///< c^2: 99.9 % quantile, 6 degrees of freedom
};

struct PoseGraphSolution {
  std::vector<Pose> T_m_b;
  std::vector<bool> inliers;  ///< of the loops
  bool usable = true;         ///< false: the solver failed, and the poses are the initial ones
};

/// Minimizes the cost by Ceres with SuiteSparse's sparse Cholesky decomposition.
[[nodiscard]] PoseGraphSolution optimize_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options);

/// Mean direction of gravity in the map, a unit vector; zero without measurements.
[[nodiscard]] Eigen::Vector3d mean_gravity(const PoseGraph& graph);

/// Weight of a loop, see above.
/// @param squared_residual |r|^2
[[nodiscard]] double graduated_weight(double squared_residual, double mu, double max_chi2);

}  // namespace stillpoint
