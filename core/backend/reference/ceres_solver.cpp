// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/ceres_solver.h"

#include <algorithm>
#include <span>
#include <utility>

#include <ceres/problem.h>
#include <ceres/solver.h>
#include <Eigen/Cholesky>

#include "core/backend/factors/ceres_manifolds.h"
#include "core/backend/reference/ceres_residuals.h"
#include "core/backend/reference/normal_equations.h"
#include "core/backend/solvers/marginalization.h"
#include "core/backend/solvers/window_solver.h"

namespace stillpoint {
namespace {

/// Elimination groups of the Schur complement.
constexpr int kLandmarkGroup = 0;
constexpr int kStateGroup = 1;

/// All residuals of a window.
ResidualBuilder build_residuals(const Window& window, const BackendConfig& config, double focal_px) {
  ResidualBuilder builder(window, config, focal_px);
  builder.add_states();
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    if (is_usable(window.landmarks[i])) builder.add_landmark(static_cast<int>(i));
  }
  return builder;
}

/// Blocks, residuals and Ceres problem of a window; in one object because they refer to each other.
class CeresProblem {
 public:
  CeresProblem(const Window& window, const BackendConfig& config, double focal_px)
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
    for (int frame = 0; frame <= window.newest(); ++frame) {
      add_state({BlockKind::kPose, frame});
      if (window.inertial) add_state({BlockKind::kSpeedBias, frame});
    }
    for (const BlockKind kind : kGlobalKinds) add_state({kind});
  }

  void add_state(BlockRef block) {
    ceres::Manifold* manifold = global_size(block.kind) == 7 ? &pose_manifold_ : nullptr;
    if (block.kind == BlockKind::kGravity) manifold = &gravity_manifold_;
    problem_.AddParameterBlock(blocks_.at(block), global_size(block.kind), manifold);
    ordering_->AddElementToGroup(blocks_.at(block), kStateGroup);
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
    for (const BlockKind kind : kGlobalKinds) {
      if (!variable.has(kind)) problem_.SetParameterBlockConstant(blocks_.at({kind}));
    }
  }

  PoseManifold pose_manifold_;
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
  CeresProblem problem(window, config, focal_px);
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

namespace {

/// Appends `size` columns from `first` on.
std::vector<int> with_columns(std::vector<int> columns, int first, int size) {
  for (int i = 0; i < size; ++i) columns.push_back(first + i);
  return columns;
}

NormalEquations linearize_oldest(const Window& window, const BackendConfig& config, double focal_px,
                                 const ParameterBlocks& blocks) {
  NormalEquations equations(static_cast<int>(window.frames.size()));
  ResidualBuilder builder(window, config, focal_px);
  builder.add_prior();
  if (window.newest() >= 1) builder.add_imu(1);
  equations.add(builder.residuals(), blocks, false);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (landmark.host != 0 || !is_usable(landmark)) continue;
    builder.clear();
    builder.add_landmark(static_cast<int>(i));
    equations.add(builder.residuals(), blocks, has_constant_depth(landmark, config),
                  marginalized_fraction(landmark, window, config));
  }
  return equations;
}

}  // namespace

LinearPrior CeresSolver::marginalize_oldest(const Window& window, const BackendConfig& config,
                                            double focal_px, LinearPrior /*recycled*/) {
  const ParameterBlocks blocks(window);
  const NormalEquations equations = linearize_oldest(window, config, focal_px, blocks);
  const StateLayout& layout = equations.layout;

  std::vector<int> marginalized = with_columns({}, layout.column({BlockKind::kPose, 0}), 6);
  if (window.inertial)
    marginalized = with_columns(std::move(marginalized), layout.column({BlockKind::kSpeedBias, 0}), 9);

  ParameterBlocks point;
  const Linearization at = linearize_at(blocks, window, config, point);
  LinearPrior prior;
  std::vector<int> remaining;
  for (const BlockRef block : candidate_blocks(window, config)) {
    const int column = layout.column(block);
    const int size = local_size(block.kind);
    if (equations.H.diagonal().segment(column, size).isZero(0.0)) continue;
    remaining = with_columns(std::move(remaining), column, size);
    prior.blocks.push_back(prior_block_after_slide(block, at.point));
  }
  if (remaining.empty()) return prior;
  const SquareRoot root = eliminate(equations.H, equations.b, marginalized, remaining);
  prior.jacobian = root.jacobian;
  prior.residual = root.residual;
  if (at.at_first_estimates()) move_residual_to_linearization(blocks, prior);
  return prior;
}

namespace {

/// All variable states; those of `newest_blocks` first.
std::vector<BlockRef> variable_blocks(const Window& window, const BackendConfig& config) {
  std::vector<BlockRef> blocks = newest_blocks(window, config);
  for (int frame = 0; frame < window.newest(); ++frame) {
    blocks.push_back({BlockKind::kPose, frame});
    if (window.inertial) blocks.push_back({BlockKind::kSpeedBias, frame});
  }
  return blocks;
}

std::vector<int> columns_of(std::span<const BlockRef> blocks, const StateLayout& layout) {
  std::vector<int> columns;
  for (const BlockRef block : blocks) {
    for (int i = 0; i < local_size(block.kind); ++i) columns.push_back(layout.column(block) + i);
  }
  return columns;
}

}  // namespace

std::optional<WindowCovariance> CeresSolver::covariance(const Window& window, const BackendConfig& config,
                                                        double focal_px, bool oldest_motion) {
  const NormalEquations equations = linearize_all(window, config, focal_px, ParameterBlocks(window));
  const std::vector<int> columns = columns_of(variable_blocks(window, config), equations.layout);
  const Eigen::MatrixXd H = equations.H(columns, columns);
  const Eigen::VectorXd unit = H.diagonal().cwiseSqrt().cwiseInverse();  // makes the diagonal entries 1
  const Eigen::LLT<Eigen::MatrixXd> factor(unit.asDiagonal() * H * unit.asDiagonal());
  if (!unit.allFinite() || factor.info() != Eigen::Success) return std::nullopt;

  const Eigen::MatrixXd inverse =
      unit.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(H.rows(), H.rows())) * unit.asDiagonal();
  const auto inverse_blocks = [&](std::span<const BlockRef> blocks) {
    std::vector<Eigen::Index> selected;
    for (const int column : columns_of(blocks, equations.layout))
      selected.push_back(std::ranges::find(columns, column) - columns.begin());
    return NewestMatrix(inverse(selected, selected));
  };
  const std::vector<BlockRef> blocks = newest_blocks(window, config);
  WindowCovariance result{.newest = state_covariance(blocks, inverse_blocks(blocks))};
  const Eigen::VectorXd step = -inverse * equations.b(columns);
  result.rig_step =
      rig_step(blocks, step.head(static_cast<Eigen::Index>(columns_of(blocks, equations.layout).size())));
  if (oldest_motion) result.oldest_motion = oldest_motion_of(window, inverse_blocks(kOldestPoses));
  return result;
}

}  // namespace stillpoint
