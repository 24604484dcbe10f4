// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/pose_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "core/backend/factors/ceres_manifolds.h"
#include "core/loop/pose_graph_factors.h"

namespace stillpoint {
namespace {

constexpr double kMuFactor = 3.0;  // per weighted problem; smaller ones need more problems
constexpr int kMaxProblems = 30;
constexpr int kStepsPerProblem = 2;
constexpr int kFinalSteps = 20;
constexpr double kInlierWeight = 0.5;

/// The rotation by the smallest angle that takes `from` to `to`, unit vectors that are not opposite. Not
/// Eigen's FromTwoVectors, which compiles a singular value decomposition for opposite vectors.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const double scale = std::sqrt(2.0 * (1.0 + from.dot(to)));  // twice the cosine of half the angle
  Eigen::Quaterniond q;
  q.vec() = from.cross(to) / scale;
  q.w() = 0.5 * scale;
  return q;
}

/// The Ceres problem of a pose graph.
class GraphProblem {
 public:
  GraphProblem(const PoseGraph& graph, const PoseGraphOptions& options)
      : graph_(graph),
        options_(options),
        gravity_m_(mean_gravity(graph)),
        heading_(gravity_m_),
        weights_(graph.loops.size(), 1.0),
        problem_(problem_options()) {
    for (const Pose& pose : graph.T_m_b) blocks_.push_back(block_of(pose));
    if (options.dof == 4) align_with_gravity();
    for (PoseBlock& block : blocks_) {
      if (options.dof == 4) {
        problem_.AddParameterBlock(block.data(), 7, &heading_);
      } else {
        problem_.AddParameterBlock(block.data(), 7, &full_);
      }
    }
    problem_.SetParameterBlockConstant(blocks_.front().data());
    for (const GraphEdge& edge : graph.odometry) add_edge(edge, one_);
    for (std::size_t i = 0; i < graph.loops.size(); ++i) add_edge(graph.loops[i], weights_[i]);
    if (options.dof == 6) add_gravity();
  }

  /// Graduated non-convexity. @return false if a problem has no usable solution
  [[nodiscard]] bool solve() {
    const double c2 = options_.max_loop_chi2;
    double mu = 0.0;
    for (int problem = 0; problem < kMaxProblems; ++problem) {
      const std::vector<double> squared = squared_residuals();
      const double largest = squared.empty() ? 0.0 : *std::ranges::max_element(squared);
      if (problem == 0) mu = 2.0 * largest > c2 ? c2 / (2.0 * largest - c2) : -1.0;
      if (mu < 0.0) break;  // all loops are inliers
      for (std::size_t i = 0; i < squared.size(); ++i) weights_[i] = graduated_weight(squared[i], mu, c2);
      if (problem > 0 && are_binary()) break;
      if (!step(kStepsPerProblem)) return false;
      mu *= kMuFactor;
    }
    for (double& weight : weights_) weight = weight >= kInlierWeight ? 1.0 : 0.0;
    return step(kFinalSteps);
  }

  [[nodiscard]] PoseGraphSolution solution() const {
    PoseGraphSolution result;
    for (const PoseBlock& block : blocks_) result.T_m_b.push_back(pose_of(block));
    for (const double weight : weights_) result.inliers.push_back(weight > 0.0);
    return result;
  }

 private:
  /// Gives all poses their measured inclination, which four degrees of freedom do not change.
  void align_with_gravity() {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (!graph_.gravity_b[i]) continue;
      Pose pose = graph_.T_m_b[i];
      pose.q = (rotation_between(pose.q * *graph_.gravity_b[i], gravity_m_) * pose.q).normalized();
      blocks_[i] = block_of(pose);
    }
  }

  void add_edge(const GraphEdge& edge, const double& weight) {
    factors_.emplace_back(edge, weight);
    problem_.AddResidualBlock(&factors_.back(), nullptr, blocks_[static_cast<std::size_t>(edge.i)].data(),
                              blocks_[static_cast<std::size_t>(edge.j)].data());
  }

  void add_gravity() {
    if (gravity_m_.isZero()) return;
    problem_.AddParameterBlock(gravity_m_.data(), 3, &sphere_);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (!graph_.gravity_b[i]) continue;
      gravity_factors_.emplace_back(*graph_.gravity_b[i], options_.gravity_sigma_rad);
      problem_.AddResidualBlock(&gravity_factors_.back(), nullptr, blocks_[i].data(), gravity_m_.data());
    }
  }

  /// |r|^2 of the loops with weight 1.
  [[nodiscard]] std::vector<double> squared_residuals() const {
    std::vector<double> squared;
    constexpr double kOne = 1.0;
    for (const GraphEdge& edge : graph_.loops) {
      const RelativePoseFactor factor(edge, kOne);
      const std::array<const double*, 2> blocks = {blocks_[static_cast<std::size_t>(edge.i)].data(),
                                                   blocks_[static_cast<std::size_t>(edge.j)].data()};
      Eigen::Matrix<double, 6, 1> residual;
      static_cast<void>(factor.Evaluate(blocks.data(), residual.data(), nullptr));
      squared.push_back(residual.squaredNorm());
    }
    return squared;
  }

  [[nodiscard]] bool are_binary() const {
    return std::ranges::all_of(weights_, [](double weight) { return weight == 0.0 || weight == 1.0; });
  }

  [[nodiscard]] bool step(int iterations) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.max_num_iterations = iterations;
    options.initial_trust_region_radius = 1e12;  // close to the minimum: Gauss-Newton steps
    options.max_trust_region_radius = 1e16;
    options.function_tolerance = 1e-6;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary.IsSolutionUsable();
  }

  const PoseGraph& graph_;
  PoseGraphOptions options_;
  Eigen::Vector3d gravity_m_;
  PoseManifold full_;
  HeadingManifold heading_;
  GravityManifold sphere_;
  double one_ = 1.0;
  std::vector<double> weights_;   ///< of the loops
  std::deque<PoseBlock> blocks_;  ///< addresses are constant
  std::deque<RelativePoseFactor> factors_;
  std::deque<GravityFactor> gravity_factors_;
  ceres::Problem problem_;
};

}  // namespace

Eigen::Vector3d mean_gravity(const PoseGraph& graph) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < graph.T_m_b.size(); ++i) {
    if (graph.gravity_b[i]) sum += graph.T_m_b[i].q * *graph.gravity_b[i];
  }
  return sum.norm() > 0.0 ? sum.normalized() : sum;
}

double graduated_weight(double squared_residual, double mu, double max_chi2) {
  if (squared_residual <= mu / (mu + 1.0) * max_chi2) return 1.0;
  if (squared_residual >= (mu + 1.0) / mu * max_chi2) return 0.0;
  return std::sqrt(max_chi2 / squared_residual * mu * (mu + 1.0)) - mu;
}

PoseGraphSolution optimize_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options) {
  GraphProblem problem(graph, options);
  if (problem.solve()) return problem.solution();
  return {.T_m_b = graph.T_m_b, .inliers = std::vector<bool>(graph.loops.size(), false), .usable = false};
}

}  // namespace stillpoint
