// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/marginalization.h"

#include <gtest/gtest.h>

#include "core/backend/sliding_window.h"
#include "core/backend/solvers/window_problem.h"
#include "core/backend/start/initial_prior.h"
#include "core/backend/window/landmark_tracks.h"
#include "tests/support/published_config.h"
#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;

LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config) {
  return make_window_solver(config.solver)->marginalize_oldest(window, config, kFocal_px, {});
}

TEST(Marginalization, ExactDataGiveAZeroResidual) {
  Window window = visual_window(5, 30);
  window.prior = initial_prior(window, BackendConfig{});
  const LinearPrior prior = marginalize_oldest(window, {});
  EXPECT_EQ(prior.blocks.size(), 4u);  // poses 1..4, now 0..3
  EXPECT_EQ(prior.blocks.front().frame, 0);
  EXPECT_LT(prior.residual.norm(), 1e-6);
}

TEST(Marginalization, ThePriorPullsADisplacedFrameBack) {
  const Window truth = visual_window(5, 30);
  Window window = truth;
  BackendConfig config;
  config.depth.usage = DepthUsage::kWeighted;
  window.prior = initial_prior(window, config);
  window.prior = marginalize_oldest(window, config);
  remove_oldest_frame(window);
  window.landmarks.clear();  // the prior alone must constrain the poses
  for (WindowFrame& frame : window.frames) frame.state.T_w_b.p += Eigen::Vector3d(0.01, -0.02, 0.015);
  ASSERT_TRUE(make_window_solver(config.solver)->solve(window, config, kFocal_px).usable);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    EXPECT_LT((window.frames[i].state.T_w_b.p - truth.frames[i + 1].state.T_w_b.p).norm(), 1e-6);
  }
}

TEST(Marginalization, AnUnconnectedFrameLeavesAnEmptyPrior) {
  Window window = visual_window(5, 30);
  window.prior = initial_prior(window, BackendConfig{});  // of frame 0 alone
  window.landmarks.clear();
  for (const WindowSolverKind kind : {WindowSolverKind::kCeres, WindowSolverKind::kSchur}) {
    BackendConfig config;
    config.solver = kind;
    EXPECT_TRUE(marginalize_oldest(window, config).empty());
  }
}

/// With zero Jacobians and residuals.
LinearPrior prior_of_two_poses(int rows) {
  Eigen::VectorXd origin(7);
  origin << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  LinearPrior prior;
  prior.blocks = {{BlockKind::kPose, 0, origin}, {BlockKind::kPose, 1, origin}};
  prior.jacobian = Eigen::MatrixXd::Zero(rows, 12);
  prior.residual = Eigen::VectorXd::Zero(rows);
  return prior;
}

TEST(Marginalization, RemovingAFrameFromAPriorPreservesTheMarginalsOfTheOthers) {
  // x0 - x1 = 0 and x1 = 0, both with unit weight.
  LinearPrior prior = prior_of_two_poses(12);
  prior.jacobian.topLeftCorner<6, 6>().setIdentity();
  prior.jacobian.topRightCorner<6, 6>() = -Eigen::MatrixXd::Identity(6, 6);
  prior.jacobian.bottomRightCorner<6, 6>().setIdentity();
  const LinearPrior remaining = FrameMarginalizer().remove(1, prior);
  ASSERT_EQ(remaining.blocks.size(), 1u);
  const Eigen::MatrixXd information = remaining.jacobian.transpose() * remaining.jacobian;
  // variances add: 1 + 1 = 2, so the information is 1/2
  EXPECT_LT((information - 0.5 * Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-9);
}

/// x1 is known along one direction only. The other entries of its columns are rounding errors, with which a
/// row that determines x0 must not be explained.
TEST(Marginalization, RoundingErrorsOfAFrameDoNotRemoveTheInformationOfOthers) {
  LinearPrior prior = prior_of_two_poses(7);
  prior.jacobian.topLeftCorner<6, 6>() = 100.0 * Eigen::MatrixXd::Identity(6, 6);
  prior.jacobian.block<6, 6>(0, 6) = 1e-10 * Eigen::MatrixXd::Identity(6, 6);
  prior.jacobian(6, 6) = 1000.0;
  const LinearPrior remaining = FrameMarginalizer().remove(1, prior);
  const Eigen::MatrixXd information = remaining.jacobian.transpose() * remaining.jacobian;
  EXPECT_LT((information - 1e4 * Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-3);
}

/// Five frames with an IMU; the first landmark is lost after frame 3.
Window inertial_window_with_ended_track() {
  Window window = visual_window(5, 30);
  window.inertial = true;
  window.landmarks.front().observations.pop_back();
  return window;
}

TEST(Marginalization, TheConsistentPriorTakesInformationFromTheObservations) {
  BackendConfig config;
  config.prior = PriorModel::kConsistent;
  Window window = inertial_window_with_ended_track();
  const double fraction = marginalized_fraction(window.landmarks.back(), window, config);
  EXPECT_GT(fraction, 0.0);
  EXPECT_LT(fraction, 1.0);
  EXPECT_EQ(marginalized_fraction(window.landmarks.front(), window, config), 1.0);
  remove_marginalized_information(config, window);
  remove_oldest_frame(window);
  EXPECT_EQ(window.landmarks.size(), 29u);  // nothing remains of the ended track
  for (const Observation& observation : window.landmarks.back().observations) {
    EXPECT_DOUBLE_EQ(observation.information, 1.0 - fraction);
  }
}

TEST(Marginalization, ThePublishedPriorCountsObservationsAgain) {
  const BackendConfig config = published_config().backend;
  Window window = inertial_window_with_ended_track();
  EXPECT_EQ(marginalized_fraction(window.landmarks.back(), window, config), 1.0);
  remove_marginalized_information(config, window);
  remove_oldest_frame(window);
  EXPECT_EQ(window.landmarks.size(), 30u);
  EXPECT_EQ(window.landmarks.back().observations.front().information, 1.0);
}

}  // namespace
}  // namespace stillpoint
