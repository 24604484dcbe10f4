// SPDX-License-Identifier: BSD-3-Clause
// Compares the Schur solver with Ceres and its cost functions, which have separate tests.
#include "core/backend/solvers/schur_solver.h"

#include <gtest/gtest.h>

#include "core/backend/reference/ceres_solver.h"
#include "core/backend/reference/normal_equations.h"
#include "core/backend/solvers/reduced_system.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

/// A window configuration.
struct Case {
  const char* name;
  SimulatedWindowOptions options;
  double readout_offset_s = 0.0;  // of a rolling shutter, top to bottom

  [[nodiscard]] Window window() const {
    Window result = simulated_window(options);
    for (Landmark& landmark : result.landmarks) {
      for (Observation& o : landmark.observations) o.readout_offset_s = readout_offset_s * o.bearing.y();
    }
    return result;
  }
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Case make_case(const char* name, const std::function<void(SimulatedWindowOptions&)>& change,
               double readout_offset_s = 0.0) {
  Case result{.name = name, .options = {.frames = 14, .points = 80}, .readout_offset_s = readout_offset_s};
  result.options.config.solver = WindowSolverKind::kSchur;
  change(result.options);
  return result;
}

const std::vector<Case> kCases = {
    make_case("WeightedDepth", [](SimulatedWindowOptions&) {}),
    make_case("FixedDepth", [](SimulatedWindowOptions& o) { o.config.depth.usage = DepthUsage::kFixed; }),
    make_case("FarDepthUnknown", [](SimulatedWindowOptions& o) { o.config.depth.max_m = 3.5; }),
    make_case("VisualOnly", [](SimulatedWindowOptions& o) { o.inertial = false; }),
    make_case("WithoutTimeOffset", [](SimulatedWindowOptions& o) { o.config.estimate_time_offset = false; }),
    make_case("WithExtrinsics", [](SimulatedWindowOptions& o) { o.config.estimate_extrinsics = true; }),
    make_case(
        "RollingShutter", [](SimulatedWindowOptions&) {}, 0.02),
    make_case("WithGravity", [](SimulatedWindowOptions& o) { o.config.gravity = GravityModel::kEstimated; }),
    make_case("WithGravityAndExtrinsics",
              [](SimulatedWindowOptions& o) {
                o.config.gravity = GravityModel::kEstimated;
                o.config.estimate_extrinsics = true;
                o.config.estimate_time_offset = false;
              }),
    make_case("ConsistentPrior",
              [](SimulatedWindowOptions& o) {
                o.config.gravity = GravityModel::kEstimated;
                o.config.prior = PriorModel::kConsistent;
                o.config.estimate_extrinsics = true;
                o.frames = 24;
              }),
    make_case(
        "InertialTimeOffset",
        [](SimulatedWindowOptions& o) {
          o.config.time_offset_model = TimeOffsetModel::kInertial;
          o.config.gravity = GravityModel::kEstimated;
          o.config.prior = PriorModel::kConsistent;
          o.time_offset_s = 0.02;
          o.frames = 24;
        },
        0.02),
    make_case("DepthScale",
              [](SimulatedWindowOptions& o) {
                o.config.depth.estimate_scale = true;
                o.depth_factor = 0.95;
              }),
    make_case("AllCalibration",
              [](SimulatedWindowOptions& o) {
                o.config.time_offset_model = TimeOffsetModel::kInertial;
                o.config.gravity = GravityModel::kEstimated;
                o.config.prior = PriorModel::kConsistent;
                o.config.estimate_extrinsics = true;
                o.config.depth.estimate_scale = true;
                o.config.estimate_lens = true;
                o.depth_factor = 1.03;
                o.time_offset_s = -0.01;
                o.frames = 24;
              }),
    make_case("FewFrames", [](SimulatedWindowOptions& o) { o.frames = 6; })};

class SchurSolverCase : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Windows, SchurSolverCase, testing::ValuesIn(kCases),
                         [](const auto& tested) { return tested.param.name; });

/// The normal equations by the terms of the Schur solver, landmarks eliminated.
ReducedSystem reduced_system(const Window& window, const BackendConfig& config,
                             const ParameterBlocks& blocks) {
  VisualTerms visual;
  PriorTerm prior;
  PriorTerm calibration;
  ReducedSystem system;
  visual.read(window, config, kSimulatedFocal_px, LandmarkSelection::kAll);
  prior.read(window.prior);
  calibration.read(window.calibration);
  system.reset(ReducedLayout(static_cast<int>(window.frames.size()), window.inertial,
                             variable_globals(window, config)));
  ParameterBlocks point;
  const Linearization at = linearize_at(blocks, window, config, point);
  prior.add_to(system, blocks);
  calibration.add_to(system, blocks);
  for (int frame = 1; frame <= window.newest(); ++frame) {
    if (has_imu_term(window, frame)) add_imu_term(window, frame, at, system);
  }
  visual.add_to(system, at);
  Eigen::VectorXd rhs = -system.g;
  visual.eliminate(0.0, system.H, rhs);
  system.g = -rhs;
  return system;
}

/// Columns of every variable state in both layouts.
struct ColumnPairs {
  std::vector<int> reference;
  std::vector<int> reduced;
};

ColumnPairs matching_columns(const Window& window, const ReducedLayout& reduced) {
  const StateLayout reference(static_cast<int>(window.frames.size()));
  std::vector<BlockRef> blocks;
  for (const BlockKind kind : kGlobalKinds) blocks.push_back({kind});
  for (int frame = 0; frame <= window.newest(); ++frame) {
    blocks.push_back({BlockKind::kPose, frame});
    blocks.push_back({BlockKind::kSpeedBias, frame});
  }
  ColumnPairs pairs;
  for (const BlockRef block : blocks) {
    for (int i = 0; i < local_size(block.kind) && reduced.column(block) >= 0; ++i) {
      pairs.reference.push_back(reference.column(block) + i);
      pairs.reduced.push_back(reduced.column(block) + i);
    }
  }
  return pairs;
}

TEST_P(SchurSolverCase, NormalEquationsEqualThoseOfTheCostFunctions) {
  const Window window = GetParam().window();
  const BackendConfig& config = GetParam().options.config;
  const ParameterBlocks blocks(window);
  const NormalEquations reference = linearize_all(window, config, kSimulatedFocal_px, blocks);
  const ReducedSystem reduced = reduced_system(window, config, blocks);
  const ColumnPairs columns = matching_columns(window, reduced.layout);

  const Eigen::MatrixXd full = reduced.H.selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd H = full(columns.reduced, columns.reduced);
  const Eigen::MatrixXd H_reference = reference.H(columns.reference, columns.reference);
  const Eigen::VectorXd axis = H_reference.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  // entries relative to the square root of the diagonal entries of row and column
  EXPECT_LT((axis.asDiagonal() * (H - H_reference) * axis.asDiagonal()).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::VectorXd g = axis.cwiseProduct(reduced.g(columns.reduced));
  const Eigen::VectorXd g_reference = axis.cwiseProduct(reference.b(columns.reference));
  EXPECT_LT((g - g_reference).norm(), 1e-9 * g_reference.norm());
}

TEST_P(SchurSolverCase, ReachesTheCostOfCeres) {
  const BackendConfig& config = GetParam().options.config;
  Window by_schur = GetParam().window();
  Window by_ceres = by_schur;
  const SolveReport schur = SchurSolver().solve(by_schur, config, kSimulatedFocal_px);
  const SolveReport ceres = CeresSolver().solve(by_ceres, config, kSimulatedFocal_px);
  ASSERT_TRUE(schur.usable && ceres.usable);
  EXPECT_EQ(schur.landmarks, ceres.landmarks);
  EXPECT_EQ(schur.depth_landmarks, ceres.depth_landmarks);
  EXPECT_NEAR(schur.initial_cost, ceres.initial_cost, 1e-9 * ceres.initial_cost);
  EXPECT_LT(schur.final_cost, 0.9 * schur.initial_cost);
  EXPECT_NEAR(schur.final_cost, ceres.final_cost, 1e-3 * ceres.final_cost);
  for (std::size_t i = 0; i < by_schur.frames.size(); ++i) {
    EXPECT_LT((by_schur.frames[i].state.T_w_b.p - by_ceres.frames[i].state.T_w_b.p).norm(), 1e-4);
  }
  EXPECT_LT((by_schur.gravity_w - by_ceres.gravity_w).norm(), 1e-3);
}

TEST_P(SchurSolverCase, MarginalizationYieldsTheSameInformation) {
  const Window window = GetParam().window();
  const BackendConfig& config = GetParam().options.config;
  const LinearPrior root = SchurSolver().marginalize_oldest(window, config, kSimulatedFocal_px, {});
  const LinearPrior reference = CeresSolver().marginalize_oldest(window, config, kSimulatedFocal_px, {});
  ASSERT_EQ(root.blocks.size(), reference.blocks.size());
  for (std::size_t i = 0; i < root.blocks.size(); ++i) {
    EXPECT_EQ(root.blocks[i].kind, reference.blocks[i].kind);
    EXPECT_EQ(root.blocks[i].frame, reference.blocks[i].frame);
    EXPECT_EQ(root.blocks[i].linearization, reference.blocks[i].linearization);
  }
  const Eigen::MatrixXd H = root.jacobian.transpose() * root.jacobian;
  const Eigen::MatrixXd H_reference = reference.jacobian.transpose() * reference.jacobian;
  EXPECT_LT((H - H_reference).norm(), 1e-9 * H_reference.norm());
  const Eigen::VectorXd g = root.jacobian.transpose() * root.residual;
  const Eigen::VectorXd g_reference = reference.jacobian.transpose() * reference.residual;
  EXPECT_LT((g - g_reference).norm(), 1e-6 * g_reference.norm());
}

TEST(SchurSolver, TheResultDoesNotDependOnEarlierSolves) {
  const Window start = kCases[0].window();
  const BackendConfig& config = kCases[0].options.config;
  Window fresh = start;
  SchurSolver solver;
  static_cast<void>(solver.solve(fresh, config, kSimulatedFocal_px));
  Window other = kCases[3].window();
  static_cast<void>(solver.solve(other, kCases[3].options.config, kSimulatedFocal_px));
  Window again = start;
  static_cast<void>(solver.solve(again, config, kSimulatedFocal_px));
  for (std::size_t i = 0; i < fresh.frames.size(); ++i) {  // bitwise
    EXPECT_EQ(fresh.frames[i].state.T_w_b.p, again.frames[i].state.T_w_b.p);
    EXPECT_EQ(fresh.frames[i].state.T_w_b.q.coeffs(), again.frames[i].state.T_w_b.q.coeffs());
    EXPECT_EQ(fresh.frames[i].state.v_w, again.frames[i].state.v_w);
  }
}

TEST(SchurSolver, AStepThatIncreasesTheCostIsRejected) {
  // With the newest camera rotated by 70 degrees all residuals are large and Newton steps overshoot.
  const Case& c = kCases[3];
  Window window = c.window();
  window.frames.back().state.T_w_b.q = window.frames.back().state.T_w_b.q * exp_so3({0.0, 0.0, 1.2});
  BackendConfig config = c.options.config;
  config.cauchy_scale = 100.0;  // nearly quadratic: at unit scale the Cauchy gradient vanishes this far out
  config.max_iterations = 40;
  SchurSolver solver;
  const SolveReport report = solver.solve(window, config, kSimulatedFocal_px);
  EXPECT_TRUE(report.usable);
  EXPECT_LT(report.final_cost, 0.01 * report.initial_cost);
}

TEST(SchurSolver, LeavesTheWindowUnchangedIfTheCostIsNan) {
  Window window = kCases[0].window();
  window.frames.back().state.T_w_b.p.x() = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d before = window.frames.front().state.T_w_b.p;
  SchurSolver solver;
  EXPECT_FALSE(solver.solve(window, kCases[0].options.config, kSimulatedFocal_px).usable);
  EXPECT_EQ(window.frames.front().state.T_w_b.p, before);
}

}  // namespace
}  // namespace stillpoint
