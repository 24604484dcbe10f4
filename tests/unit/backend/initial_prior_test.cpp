// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/initial_prior.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace stillpoint {
namespace {

/// Two frames 1 m apart along x.
Window two_frames() {
  Window window;
  window.frames.resize(2);
  window.frames[1].state.T_w_b.p.x() = 1.0;
  return window;
}

TEST(RestoreGauge, MovesTheWholeWindowBackAfterAJump) {
  Window window = two_frames();
  const Pose oldest = window.frames.front().state.T_w_b;
  const Pose jump{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY())), {0.0, 0.6, 0.2}};
  for (WindowFrame& frame : window.frames) frame.state.T_w_b = jump * frame.state.T_w_b;
  EXPECT_TRUE(restore_gauge(oldest, {}, window));
  EXPECT_LT(window.frames[0].state.T_w_b.p.norm(), 1e-12);
  EXPECT_LT((window.frames[1].state.T_w_b.p - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(RestoreGauge, IgnoresAShiftOfCentimeters) {
  Window window = two_frames();
  const Pose oldest = window.frames.front().state.T_w_b;
  for (WindowFrame& frame : window.frames) frame.state.T_w_b.p.y() += 0.05;
  EXPECT_FALSE(restore_gauge(oldest, {}, window));
  EXPECT_EQ(window.frames[0].state.T_w_b.p.y(), 0.05);
}

TEST(AlignedCalibrationPrior, HasTheCovarianceOfTheAlignment) {
  BackendConfig config;
  config.extrinsics_sigma_m = 0.02;
  config.depth.estimate_scale = true;
  config.depth.scale_sigma = 0.1;
  const Eigen::Vector4d common(2.0, -1.0, 0.5, 0.3);
  const Eigen::Matrix4d aligned = 1e-4 * (common * common.transpose() +
                                          Eigen::Matrix4d(Eigen::Vector4d(1.0, 2.0, 3.0, 0.1).asDiagonal()));
  const LinearPrior prior = aligned_calibration_prior(two_frames(), config, aligned);
  const Eigen::MatrixXd covariance = (prior.jacobian.transpose() * prior.jacobian).inverse();
  EXPECT_TRUE((covariance.block<4, 4>(3, 3)).isApprox(aligned, 1e-9));
  EXPECT_TRUE((covariance.topLeftCorner<3, 3>()).isApprox(4e-4 * Eigen::Matrix3d::Identity(), 1e-9));
  EXPECT_NEAR(covariance(7, 7), 0.01, 1e-9);
  EXPECT_TRUE(prior.residual.isZero());
}

}  // namespace
}  // namespace stillpoint
