// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/window_solver.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "core/backend/factors/pose_manifold.h"
#include "core/backend/solvers/schur_solver.h"
#include "core/backend/solvers/window_problem.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Elimination groups of the Schur complement.
constexpr int kLandmarkGroup = 0;
constexpr int kStateGroup = 1;

std::vector<Residual> make_residuals(const Window& window, ResidualBuilder& builder, SolveReport& report) {
  std::vector<Residual> residuals;
  builder.add_prior(residuals);
  builder.add_calibration(residuals);
  for (int frame = 1; frame <= window.newest(); ++frame) builder.add_imu(frame, residuals);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    if (!is_usable(window.landmarks[i])) continue;
    builder.add_landmark(static_cast<int>(i), residuals);
    ++report.landmarks;
    report.depth_landmarks += window.landmarks[i].source == DepthSource::kMeasured;
  }
  return residuals;
}

/// Blocks, residuals and Ceres problem of a window; in one object because they refer to each other.
class WindowProblem {
 public:
  WindowProblem(const Window& window, const BackendConfig& config, double focal_px, SolveReport& report)
      : blocks_(window),
        builder_(window, config, focal_px),
        residuals_(make_residuals(window, builder_, report)),
        problem_(options()) {
    add_states(window);
    for (const Residual& r : residuals_) {
      problem_.AddResidualBlock(r.cost.get(), r.loss, parameter_addresses(r, blocks_));
    }
    order_landmarks(window, config);
    set_calibration_constancy(window, config);
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

  [[nodiscard]] ParameterBlocks& blocks() { return blocks_; }

 private:
  static ceres::Problem::Options options() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  void add_states(const Window& window) {
    for (std::size_t i = 0; i < window.frames.size(); ++i) {
      add_state(blocks_.pose(i), 7, &manifold_);
      if (window.inertial) add_state(blocks_.speed_bias(i), 9, nullptr);
    }
    add_state(blocks_.extrinsics(), 7, &manifold_);
    add_state(blocks_.time_offset(), 1, nullptr);
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

  void set_calibration_constancy(const Window& window, const BackendConfig& config) {
    const VariableCalibration variable = variable_calibration(window, config);
    if (!variable.extrinsics) problem_.SetParameterBlockConstant(blocks_.extrinsics());
    if (!variable.time_offset) problem_.SetParameterBlockConstant(blocks_.time_offset());
  }

  PoseManifold manifold_;
  ParameterBlocks blocks_;
  ResidualBuilder builder_;
  std::vector<Residual> residuals_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
      std::make_shared<ceres::ParameterBlockOrdering>();
  ceres::Problem problem_;
  bool has_variable_landmarks_ = false;
};

/// Resets landmarks at infinity or behind their host, so that their depth is initialized again.
void invalidate_lost_depths(const DepthConfig& config, Window& window) {
  for (Landmark& landmark : window.landmarks) {
    if (landmark.inverse_depth * config.max_landmark_depth_m < 1.0) landmark.inverse_depth = 0.0;
  }
}

SolveReport solve_by_ceres(Window& window, const BackendConfig& config, double focal_px) {
  STILLPOINT_CHECK(!window.prior.empty());
  SolveReport report;
  WindowProblem problem(window, config, focal_px, report);
  const ceres::Solver::Summary summary = problem.solve(config);
  report.iterations = static_cast<int>(summary.iterations.size());
  report.initial_cost = summary.initial_cost;
  report.final_cost = summary.final_cost;
  report.usable = summary.IsSolutionUsable();
  if (report.usable) unpack(problem.blocks(), window);
  return report;
}

}  // namespace

SolveReport solve_window(Window& window, const BackendConfig& config, double focal_px) {
  SchurSolver solver;
  return solve_window(window, config, focal_px, solver);
}

SolveReport solve_window(Window& window, const BackendConfig& config, double focal_px, SchurSolver& solver) {
  const SolveReport report = config.solver == WindowSolverKind::kSchur
                                 ? solver.solve(window, config, focal_px)
                                 : solve_by_ceres(window, config, focal_px);
  if (report.usable) invalidate_lost_depths(config.depth, window);
  return report;
}

}  // namespace stillpoint
