// SPDX-License-Identifier: BSD-3-Clause
// Compares the covariances of the newest state and of the motion between the oldest ones with the inverse of
// the information of all states and landmarks.
#include "core/backend/solvers/window_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/backend/reference/ceres_solver.h"
#include "core/backend/reference/normal_equations.h"
#include "core/backend/solvers/schur_solver.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Information of all states, in the order of StateLayout, and of all landmarks, one column each.
class FullInformation {
 public:
  FullInformation(const Window& window, const BackendConfig& config) : window_(window), config_(config) {
    const Eigen::Index size = layout_.size() + static_cast<Eigen::Index>(window.landmarks.size());
    H_ = Eigen::MatrixXd::Zero(size, size);
    ResidualBuilder builder(window, config, kSimulatedFocal_px);
    builder.add_states();
    for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
      if (is_usable(window.landmarks[i])) builder.add_landmark(static_cast<int>(i));
    }
    for (const Residual& residual : builder.residuals()) add(residual);
  }

  /// Rows and columns of the blocks in the inverse; states without information are constant.
  [[nodiscard]] Eigen::MatrixXd covariance(const std::vector<BlockRef>& blocks) const {
    std::vector<int> variable;
    for (int i = 0; i < static_cast<int>(H_.rows()); ++i) {
      if (H_(i, i) > 0.0 && !is_constant(i)) variable.push_back(i);
    }
    const Eigen::MatrixXd H = H_(variable, variable);
    const Eigen::VectorXd unit = H.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse = unit.asDiagonal() *
                                    (unit.asDiagonal() * H * unit.asDiagonal())
                                        .ldlt()
                                        .solve(Eigen::MatrixXd::Identity(H.rows(), H.rows()))
                                        .eval() *
                                    unit.asDiagonal();
    std::vector<Eigen::Index> selected;
    for (const BlockRef block : blocks) {
      const int column = layout_.column(block);
      const auto position = std::find(variable.begin(), variable.end(), column) - variable.begin();
      for (int i = 0; i < local_size(block.kind); ++i) selected.push_back(position + i);
    }
    return inverse(selected, selected);
  }

 private:
  [[nodiscard]] bool is_constant(int column) const {
    const VariableGlobals variable = variable_globals(window_, config_);
    if (column >= layout_.size()) {
      const auto index = static_cast<std::size_t>(column - layout_.size());
      return has_constant_depth(window_.landmarks[index], config_);
    }
    return std::ranges::any_of(kGlobalKinds, [&](BlockKind kind) {
      const int begin = layout_.column({kind});
      return column >= begin && column < begin + local_size(kind) && !variable.has(kind);
    });
  }

  void add(const Residual& residual) {
    const std::vector<int>& sizes = residual.cost->parameter_block_sizes();
    Eigen::VectorXd r(residual.cost->num_residuals());
    std::vector<RowMajor> jacobians;
    for (const int size : sizes) jacobians.emplace_back(r.size(), size);
    std::vector<double*> pointers;
    for (RowMajor& jacobian : jacobians) pointers.push_back(jacobian.data());
    ASSERT_TRUE(
        residual.cost->Evaluate(parameter_addresses(residual, blocks_).data(), r.data(), pointers.data()));
    double rho[3] = {0.0, 1.0, 0.0};
    if (residual.loss != nullptr) residual.loss->Evaluate(r.squaredNorm(), rho);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(r.size(), H_.cols());
    for (std::size_t i = 0; i < residual.states.size(); ++i) {
      const int size = local_size(residual.states[i].kind);
      J.middleCols(layout_.column(residual.states[i]), size) = jacobians[i].leftCols(size);
    }
    if (residual.landmark >= 0) J.col(layout_.size() + residual.landmark) = jacobians.back();
    H_ += rho[1] * J.transpose() * J;
  }

  const Window& window_;
  const BackendConfig& config_;
  StateLayout layout_{static_cast<int>(window_.frames.size())};
  const ParameterBlocks blocks_{window_};
  Eigen::MatrixXd H_;
};

/// Largest difference of two covariances, relative to the standard deviations of row and column.
double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& reference) {
  const Eigen::VectorXd unit = reference.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  return (unit.asDiagonal() * (a - reference) * unit.asDiagonal()).cwiseAbs().maxCoeff();
}

/// Sums in another order change the information by rounding errors, and its condition number is about 1e7.
constexpr double kRounding = 1e-8;

/// The error of the whole window cancels in the motion between two frames, and its rounding error does not.
constexpr double kDifference = 1e-6;

void expect_covariances(const SimulatedWindowOptions& options) {
  const Window window = simulated_window(options);
  const std::vector<BlockRef> blocks = newest_blocks(window, options.config);
  const FullInformation information(window, options.config);
  const StateCovariance reference = state_covariance(blocks, information.covariance(blocks));
  const Matrix6 motion =
      oldest_motion_of(window, information.covariance({kOldestPoses.begin(), kOldestPoses.end()})).covariance;
  SchurSolver schur;
  CeresSolver ceres;
  for (WindowSolver* solver : {static_cast<WindowSolver*>(&schur), static_cast<WindowSolver*>(&ceres)}) {
    const std::optional<WindowCovariance> both =
        solver->covariance(window, options.config, kSimulatedFocal_px, true);
    ASSERT_TRUE(both && both->oldest_motion);
    EXPECT_LT(relative_difference(both->oldest_motion->covariance, motion), kDifference);
    const StateCovariance* found = &both->newest;
    EXPECT_EQ(found->inertial, window.inertial);
    EXPECT_LT(relative_difference(found->state, reference.state), kRounding);
    EXPECT_LT(relative_difference(found->gravity, reference.gravity), kRounding);
    EXPECT_LT(relative_difference(found->extrinsics, reference.extrinsics), kRounding);
    EXPECT_NEAR(found->time_offset, reference.time_offset, kRounding * reference.time_offset);
    EXPECT_NEAR(found->depth_scale, reference.depth_scale, kRounding * reference.depth_scale);
  }
}

TEST(NewestCovariance, IsTheInverseOfTheInformationOfAllStates) {
  SimulatedWindowOptions options{.frames = 24, .points = 80};
  options.config.gravity = GravityModel::kEstimated;
  options.config.prior = PriorModel::kConsistent;
  options.config.estimate_extrinsics = true;
  expect_covariances(options);
}

TEST(NewestCovariance, OfTheWholeCalibration) {
  SimulatedWindowOptions options{.frames = 24, .points = 80};
  options.config.gravity = GravityModel::kEstimated;
  options.config.prior = PriorModel::kConsistent;
  options.config.time_offset_model = TimeOffsetModel::kInertial;
  options.config.estimate_extrinsics = true;
  options.config.depth.estimate_scale = true;
  options.config.estimate_lens = true;
  expect_covariances(options);
}

/// For small errors of the rig the squared step, in variances, is that of the likelihood ratio: twice the
/// decrease of the cost if the calibration becomes variable.
TEST(RigStep, IsTwiceTheCostOfTheValuesOfTheRig) {
  SimulatedWindowOptions options{.frames = 24, .points = 80, .depth_factor = 0.97};
  options.config.gravity = GravityModel::kEstimated;
  options.config.prior = PriorModel::kConsistent;
  Window window = simulated_window(options);
  options.config.depth.estimate_scale = true;
  window.agrees_with_rig.depth_scale = true;
  SchurSolver schur;
  CeresSolver ceres;
  options.config.max_iterations = 30;
  const double constant = schur.solve(window, options.config, kSimulatedFocal_px).final_cost;
  ASSERT_EQ(window.depth_scale, 1.0);
  const auto contradiction = [&](WindowSolver& solver) {
    const auto found = solver.covariance(window, options.config, kSimulatedFocal_px, false);
    return found->rig_step.depth_scale * found->rig_step.depth_scale / found->newest.depth_scale;
  };
  const double by_schur = contradiction(schur), by_ceres = contradiction(ceres);
  EXPECT_NEAR(by_schur, by_ceres, 1e-6 * by_ceres);
  window.agrees_with_rig.depth_scale = false;
  const double variable = schur.solve(window, options.config, kSimulatedFocal_px).final_cost;
  EXPECT_NE(window.depth_scale, 1.0);
  EXPECT_NEAR(by_schur, 2.0 * (constant - variable), 0.1 * by_schur);
  EXPECT_LT(contradiction(schur), 1e-6);  // converged
}

TEST(NewestCovariance, WithThePublishedPriorAndConstantDepths) {
  SimulatedWindowOptions options{.frames = 14, .points = 80};
  options.config.depth.usage = DepthUsage::kFixed;
  expect_covariances(options);
}

TEST(NewestCovariance, WithoutAnImu) { expect_covariances({.inertial = false, .frames = 14, .points = 80}); }

TEST(NewestCovariance, IsAbsentIfAStateIsUnconstrained) {
  SimulatedWindowOptions options{.frames = 14, .points = 80};
  Window window = simulated_window(options);
  window.frames.back().from_previous.reset();  // no residual involves the newest velocity and biases
  EXPECT_FALSE(SchurSolver().covariance(window, options.config, kSimulatedFocal_px, true));
  EXPECT_FALSE(CeresSolver().covariance(window, options.config, kSimulatedFocal_px, true));
}

}  // namespace
}  // namespace stillpoint
