// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/bundle_adjustment.h"

#include <array>
#include <cmath>
#include <deque>

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "core/backend/factors/gravity_manifold.h"
#include "core/backend/factors/pose_manifold.h"
#include "core/backend/factors/problem_options.h"
#include "core/loop/point_factor.h"
#include "core/loop/pose_block.h"
#include "core/loop/pose_graph_factors.h"

namespace stillpoint {
namespace {

constexpr double kLargestResidual = 3.0;  // of an observation that has an effect
constexpr int kMaxIterations = 30;

class BundleProblem {
 public:
  BundleProblem(const PoseGraph& graph, std::span<const Keyframe> keyframes,
                std::span<const MapLandmark> landmarks, const BundleAdjustmentOptions& options)
      : options_(options), gravity_m_(mean_gravity(graph)), problem_(problem_options()) {
    for (const Pose& pose : graph.T_m_b) poses_.push_back(block_of(pose));
    for (PoseBlock& pose : poses_) problem_.AddParameterBlock(pose.data(), 7, &manifold_);
    problem_.SetParameterBlockConstant(poses_.front().data());
    for (const GraphEdge& edge : graph.odometry) add_odometry(edge);
    if (!gravity_m_.isZero()) add_gravity(graph);
    for (const MapLandmark& landmark : landmarks) add_landmark(landmark, keyframes);
  }

  [[nodiscard]] BundleAdjustmentSummary solve() {
    BundleAdjustmentSummary result{.landmarks = points_.size(), .observations = observations_.size()};
    result.rms_before = rms();
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Eigen::Vector3d& point : points_) options.linear_solver_ordering->AddElementToGroup(point.data(), 0);
    for (PoseBlock& pose : poses_) options.linear_solver_ordering->AddElementToGroup(pose.data(), 1);
    if (!gravity_m_.isZero()) options.linear_solver_ordering->AddElementToGroup(gravity_m_.data(), 1);
    options.max_num_iterations = kMaxIterations;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    result.usable = summary.IsSolutionUsable();
    result.rms_after = rms();
    return result;
  }

  [[nodiscard]] std::vector<Pose> poses() const {
    std::vector<Pose> result;
    for (const PoseBlock& pose : poses_) result.push_back(pose_of(pose));
    return result;
  }

 private:
  struct Observation {
    Observation(const LandmarkObservation& seen, const Pose& T_b_c, const BundleAdjustmentOptions& options,
                const std::array<const double*, 2>& pose_and_landmark)
        : factor(seen.p_c, T_b_c, options.bearing_sigma, options.inverse_depth_sigma),
          blocks(pose_and_landmark) {}

    PointFactor factor;
    std::array<const double*, 2> blocks;  ///< pose, landmark
  };

  PoseBlock& pose(int keyframe) { return poses_[static_cast<std::size_t>(keyframe)]; }

  void add_odometry(const GraphEdge& edge) {
    odometry_.emplace_back(edge, one_);
    problem_.AddResidualBlock(&odometry_.back(), nullptr, pose(edge.i).data(), pose(edge.j).data());
  }

  void add_gravity(const PoseGraph& graph) {
    problem_.AddParameterBlock(gravity_m_.data(), 3, &sphere_);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!graph.gravity_b[i]) continue;
      gravity_.emplace_back(*graph.gravity_b[i], options_.gravity_sigma_rad);
      problem_.AddResidualBlock(&gravity_.back(), nullptr, poses_[i].data(), gravity_m_.data());
    }
  }

  /// Observations from behind the camera are left out: such features were matched wrongly.
  void add_landmark(const MapLandmark& landmark, std::span<const Keyframe> keyframes) {
    double* const point = points_.emplace_back(landmark.p_m).data();
    problem_.AddParameterBlock(point, 3);
    for (const LandmarkObservation& seen : landmark.observations) {
      double* const block = pose(seen.keyframe).data();
      const Pose& T_b_c = keyframes[static_cast<std::size_t>(seen.keyframe)].T_b_c;
      observations_.emplace_back(seen, T_b_c, options_, std::array<const double*, 2>{block, point});
      if (!std::isfinite(squared_residual(observations_.back()))) {
        observations_.pop_back();
      } else {
        problem_.AddResidualBlock(&observations_.back().factor, &tukey_, block, point);
      }
    }
  }

  static double squared_residual(const Observation& observation) {
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();
    if (!observation.factor.Evaluate(observation.blocks.data(), residual.data(), nullptr)) return INFINITY;
    return residual.squaredNorm();
  }

  /// Of the normalized residuals of the observations.
  [[nodiscard]] double rms() const {
    double sum = 0.0;
    for (const Observation& observation : observations_) sum += squared_residual(observation);
    return observations_.empty() ? 0.0 : std::sqrt(sum / (3.0 * static_cast<double>(observations_.size())));
  }

  BundleAdjustmentOptions options_;
  Eigen::Vector3d gravity_m_;
  PoseManifold manifold_;
  GravityManifold sphere_;
  ceres::TukeyLoss tukey_{kLargestResidual};
  double one_ = 1.0;
  std::deque<PoseBlock> poses_;  ///< addresses in deques are constant
  std::deque<Eigen::Vector3d> points_;
  std::deque<RelativePoseFactor> odometry_;
  std::deque<GravityFactor> gravity_;
  std::deque<Observation> observations_;
  ceres::Problem problem_;
};

}  // namespace

BundleAdjustmentResult adjust_bundle(const PoseGraph& graph, std::span<const Keyframe> keyframes,
                                     std::span<const MapLandmark> landmarks,
                                     const BundleAdjustmentOptions& options) {
  if (landmarks.empty()) return {.T_m_b = graph.T_m_b, .summary = {}};
  BundleProblem problem(graph, keyframes, landmarks, options);
  const BundleAdjustmentSummary summary = problem.solve();
  return {.T_m_b = summary.usable ? problem.poses() : graph.T_m_b, .summary = summary};
}

}  // namespace stillpoint
