// SPDX-License-Identifier: BSD-3-Clause
// The world has six unobservable degrees of freedom: position, and attitude together with gravity.
#include <gtest/gtest.h>

#include "core/backend/factors/gravity_direction.h"
#include "core/backend/solvers/schur_solver.h"
#include "core/backend/start/depth_initialization.h"
#include "core/backend/start/initial_prior.h"
#include "core/backend/window/landmark_tracks.h"
#include "core/imu/imu_buffer.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

constexpr double kInterval_s = 0.1;

/// Slides a window along a simulated motion, with noise, from a prior without any gauge.
class SlidingWindow {
 public:
  explicit SlidingWindow(const BackendConfig& config) : config_(config) {
    for (const ImuSample& sample : motion_.imu(20.0)) imu_.add(sample);
    window_.T_b_c = SimulatedMotion::rig().T_b_c;
    window_.gravity_w = exp_so3({0.01, -0.01, 0.0}) * Eigen::Vector3d(0.0, 0.0, -9.81);
    window_.gravity_covariance = 1e-2 * Eigen::Matrix2d::Identity();
    window_.inertial = true;
    push();
    window_.prior = initial_prior(window_, config_);
    window_.prior.jacobian.topRows(6).setZero();     // pose
    window_.prior.jacobian.bottomRows(2).setZero();  // gravity in the world
    window_.calibration = calibration_prior(window_, config_);
  }

  void advance() {
    push();
    initialize_depths(config_, kSimulatedFocal_px, window_);
    ASSERT_TRUE(solver_.solve(window_, config_, kSimulatedFocal_px).usable);
    if (window_.newest() < config_.window_size) return;
    window_.prior = solver_.marginalize_oldest(window_, config_, kSimulatedFocal_px, {});
    remove_oldest_frame(window_);
  }

  [[nodiscard]] const Window& window() const { return window_; }

 private:
  void push() {
    const double t = 0.1 + kInterval_s * frames_;
    WindowFrame next;
    next.state = SimulatedMotion::state(t);
    if (!window_.frames.empty()) {
      const NavState& last = window_.frames.back().state;
      next.from_previous.emplace(ImuNoise{}, last.gyro_bias, last.accel_bias);
      next.from_previous->integrate(imu_.samples_between(last.t, next.state.t));
      next.state = next.from_previous->predict(last, window_.gravity_w);
      next.state.t = from_seconds(t);
    }
    window_.frames.push_back(next);
    add_observations(motion_.frame(frames_++, t), SimulatedMotion::rig(), config_.depth, window_);
  }

  BackendConfig config_;
  SimulatedMotion motion_{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true, .points = 80};
  ImuBuffer imu_;
  SchurSolver solver_;
  Window window_;
  int frames_ = 0;
};

/// Changes of the states by a displacement of the world, at the linearization point: six columns.
Eigen::MatrixXd world_displacements(const Window& window, const ParameterBlocks& point,
                                    const ReducedLayout& layout) {
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(layout.size(), 6);
  for (int frame = 0; frame <= window.newest(); ++frame) {
    const double* pose = point.at({BlockKind::kPose, frame});
    const int column = layout.column({BlockKind::kPose, frame});
    N.block<3, 3>(column, 0).setIdentity();
    N.block<3, 3>(column, 3) = -skew(Eigen::Vector3d(pose));
    N.block<3, 3>(column + 3, 3) = Eigen::Quaterniond(pose + 3).toRotationMatrix().transpose();
    N.block<3, 3>(layout.column({BlockKind::kSpeedBias, frame}), 3) =
        -skew(Eigen::Vector3d(point.at({BlockKind::kSpeedBias, frame})));
  }
  N.block<2, 3>(layout.column({BlockKind::kGravity}), 3) =
      gravity_basis(Eigen::Vector3d(point.at({BlockKind::kGravity}))).transpose();
  return N;
}

/// Largest ratio |H n| / (|H| |n|) over the displacements n of the world, with H without a gauge, in units
/// that make its diagonal entries 1.
double null_space_error(const Window& window, const BackendConfig& config) {
  const ParameterBlocks blocks(window);
  ParameterBlocks point;
  const Linearization at = linearize_at(blocks, window, config, point);
  VisualTerms visual;
  PriorTerm prior;
  ReducedSystem system;
  visual.read(window, config, kSimulatedFocal_px, LandmarkSelection::kAll);
  prior.read(window.prior);
  system.reset(ReducedLayout(static_cast<int>(window.frames.size()), true, variable_globals(window, config)));
  prior.add_to(system, blocks);
  for (int frame = 1; frame <= window.newest(); ++frame) add_imu_term(window, frame, at, system);
  visual.add_to(system, at);
  Eigen::VectorXd rhs = -system.g;
  visual.eliminate(0.0, system.H, rhs);
  const Eigen::MatrixXd H = system.H.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd unit = H.diagonal().cwiseMax(1e-12).cwiseSqrt();
  const Eigen::MatrixXd scaled = unit.cwiseInverse().asDiagonal() * H * unit.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd N = unit.asDiagonal() * world_displacements(window, at.point, system.layout);
  return (scaled * N).colwise().norm().cwiseQuotient(N.colwise().norm()).maxCoeff() / scaled.norm();
}

double error_after_100_slides(PriorModel model) {
  BackendConfig config = simulated_window_config();
  config.gravity = GravityModel::kEstimated;
  config.prior = model;
  config.max_iterations = 4;
  config.estimate_extrinsics = true;
  SlidingWindow sliding(config);
  for (int i = 0; i < config.window_size + 100; ++i) sliding.advance();
  return null_space_error(sliding.window(), config);
}

TEST(NullSpace, AConsistentPriorGainsNoInformationAboutTheWorld) {
  EXPECT_LT(error_after_100_slides(PriorModel::kConsistent), 1e-11);
}

TEST(NullSpace, ThePublishedPriorDoes) { EXPECT_GT(error_after_100_slides(PriorModel::kPublished), 1e-7); }

}  // namespace
}  // namespace stillpoint
