// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/ceres_solver.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "core/backend/factors/gravity_manifold.h"
#include "core/backend/factors/pose_manifold.h"
#include "core/backend/factors/problem_options.h"
#include "core/backend/solvers/ceres_residuals.h"

namespace stillpoint {
namespace {

/// Elimination groups of the Schur complement.
constexpr int kLandmarkGroup = 0;
constexpr int kStateGroup = 1;

/// All residuals of a window.
ResidualBuilder build_residuals(const Window& window, const BackendConfig& config, double focal_px) {
  ResidualBuilder builder(window, config, focal_px);
  builder.add_prior();
  builder.add_calibration();
  for (int frame = 1; frame <= window.newest(); ++frame) builder.add_imu(frame);
  for (int frame = 0; frame <= window.newest(); ++frame) builder.add_zero_velocity(frame);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    if (is_usable(window.landmarks[i])) builder.add_landmark(static_cast<int>(i));
  }
  return builder;
}

/// Blocks, residuals and Ceres problem of a window; in one object because they refer to each other.
class WindowProblem {
 public:
  WindowProblem(const Window& window, const BackendConfig& config, double focal_px)
      : blocks_(window), builder_(build_residuals(window, config, focal_px)), problem_(problem_options()) {
    add_states(window);
    for (const Residual& r : builder_.residuals()) {
      problem_.AddResidualBlock(r.cost.get(), r.loss, parameter_addresses(r, blocks_));
    }
    order_landmarks(window, config);
    set_global_constancy(window, config);
  }

  ceres::Solver::Summary solve(const BackendConfig& config) {
    ceres::Solver::Options options;
    // With all landmarks constant there is nothing to eliminate, and DENSE_SCHUR would fall back to dense QR,
    // which takes three times as long.
    options.linear_solver_type = has_variable_landmarks_ ? ceres::DENSE_SCHUR : ceres::DENSE_NORMAL_CHOLESKY;
    if (has_variable_landmarks_) options.linear_solver_ordering = ordering_;
    options.trust_region_strategy_type = ceres::DOGLEG;
    options.max_num_iterations = config.max_iterations;
    options.function_tolerance = config.function_tolerance;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary;
  }

  [[nodiscard]] const ParameterBlocks& blocks() const { return blocks_; }

 private:
  void add_states(const Window& window) {
    for (std::size_t i = 0; i < window.frames.size(); ++i) {
      add_state(blocks_.pose(i), 7, &manifold_);
      if (window.inertial) add_state(blocks_.speed_bias(i), 9, nullptr);
    }
    add_state(blocks_.extrinsics(), 7, &manifold_);
    add_state(blocks_.time_offset(), 1, nullptr);
    add_state(blocks_.gravity(), 3, &gravity_manifold_);
    add_state(blocks_.depth_scale(), 1, nullptr);
  }

  void add_state(double* block, int size, ceres::Manifold* manifold) {
    problem_.AddParameterBlock(block, size, manifold);
    ordering_->AddElementToGroup(block, kStateGroup);
  }

  void order_landmarks(const Window& window, const BackendConfig& config) {
    for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
      if (!is_usable(window.landmarks[i])) continue;
      double* block = blocks_.inverse_depth(i);
      ordering_->AddElementToGroup(block, kLandmarkGroup);
      const bool constant = has_constant_depth(window.landmarks[i], config);
      if (constant) problem_.SetParameterBlockConstant(block);
      has_variable_landmarks_ |= !constant;
    }
  }

  void set_global_constancy(const Window& window, const BackendConfig& config) {
    const VariableGlobals variable = solved_globals(window, config);
    if (!variable.extrinsics) problem_.SetParameterBlockConstant(blocks_.extrinsics());
    if (!variable.time_offset) problem_.SetParameterBlockConstant(blocks_.time_offset());
    if (!variable.gravity) problem_.SetParameterBlockConstant(blocks_.gravity());
    if (!variable.depth_scale) problem_.SetParameterBlockConstant(blocks_.depth_scale());
  }

  PoseManifold manifold_;
  GravityManifold gravity_manifold_;
  ParameterBlocks blocks_;
  ResidualBuilder builder_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
      std::make_shared<ceres::ParameterBlockOrdering>();
  ceres::Problem problem_;
  bool has_variable_landmarks_ = false;
};

}  // namespace

SolveReport CeresSolver::minimize(Window& window, const BackendConfig& config, double focal_px) {
  WindowProblem problem(window, config, focal_px);
  const ceres::Solver::Summary summary = problem.solve(config);
  SolveReport report{.iterations = static_cast<int>(summary.iterations.size()),
                     .initial_cost = summary.initial_cost,
                     .final_cost = summary.final_cost,
                     .usable = summary.IsSolutionUsable()};
  for (const Landmark& landmark : window.landmarks) {
    if (!is_usable(landmark)) continue;
    ++report.landmarks;
    report.depth_landmarks += landmark.source == DepthSource::kMeasured;
  }
  if (report.usable) unpack(problem.blocks(), window);
  return report;
}

}  // namespace stillpoint
