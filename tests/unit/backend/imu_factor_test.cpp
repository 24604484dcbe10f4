// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/state_factors.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/numeric_jacobian.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

Preintegration rotating_motion() {
  Preintegration imu(ImuNoise{}, Eigen::Vector3d(0.01, -0.02, 0.03), Eigen::Vector3d(0.1, 0.0, -0.1));
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.005 * i;
    samples.push_back({from_seconds(t), {0.5 * t, 1.0 - t, 0.3}, {0.2 + t, -1.0, 9.6}});
  }
  imu.integrate(samples);
  return imu;
}

std::vector<double> pose_block(const Eigen::Vector3d& p, const Eigen::Vector3d& theta) {
  const Eigen::Quaterniond q = exp_so3(theta);
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

TEST(ImuFactor, JacobiansMatchNumericDifferentiation) {
  const Preintegration imu = rotating_motion();
  const ImuFactor factor(imu);
  const Blocks blocks = {pose_block({1.0, 2.0, 3.0}, {0.1, -0.4, 0.9}),
                         {0.5, -0.2, 0.1, 0.012, -0.019, 0.028, 0.15, -0.05, -0.08},
                         pose_block({1.1, 1.9, 3.1}, {0.2, -0.3, 1.0}),
                         {0.4, -0.1, 0.3, 0.011, -0.021, 0.03, 0.12, 0.02, -0.11},
                         {0.3, -0.2, -9.803},
                         {0.002}};
  EXPECT_LT(jacobian_error(factor, blocks), 1e-6);
  // Larger steps for gravity: the residual is almost linear in it.
  const Eigen::MatrixXd numeric = numeric_jacobians(factor, blocks, 1e-4)[4];
  const Eigen::MatrixXd analytic = analytic_jacobians(factor, blocks)[4];
  EXPECT_LT((numeric - analytic).norm(), 2e-9 * numeric.norm());
}

/// Numeric Jacobians by Richardson extrapolation, accurate to about 1e-12.
std::vector<Eigen::MatrixXd> accurate_jacobians(const ImuFactor& factor, const Blocks& blocks) {
  std::vector<Eigen::MatrixXd> coarse = numeric_jacobians(factor, blocks, 2e-3);
  const std::vector<Eigen::MatrixXd> fine = numeric_jacobians(factor, blocks, 1e-3);
  for (std::size_t i = 0; i < coarse.size(); ++i) coarse[i] = (4.0 * fine[i] - coarse[i]) / 3.0;
  return coarse;
}

TEST(ImuFactor, JacobiansMatchNumericDifferentiationWithStatesAtTheExposures) {
  const Preintegration imu = rotating_motion();
  const TimedImuResidual::Ends ends = {ImuEnd{-0.01, {0.4, -0.6, 0.9}, {1.0, -2.0, 9.0}},
                                       ImuEnd{0.02, {0.7, 0.2, -0.5}, {-1.5, 0.5, 10.0}}};
  const ImuFactor factor(imu, ends);
  const Blocks blocks = {pose_block({1.0, 2.0, 3.0}, {0.1, -0.4, 0.9}),
                         {0.5, -0.2, 0.1, 0.012, -0.019, 0.028, 0.15, -0.05, -0.08},
                         pose_block({1.1, 1.9, 3.1}, {0.2, -0.3, 1.0}),
                         {0.4, -0.1, 0.3, 0.011, -0.021, 0.03, 0.12, 0.02, -0.11},
                         {0.3, -0.2, -9.803},
                         {0.035}};
  const std::vector<Eigen::MatrixXd> numeric = accurate_jacobians(factor, blocks);
  const std::vector<Eigen::MatrixXd> analytic = analytic_jacobians(factor, blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    EXPECT_LT((numeric[i] - analytic[i]).norm(), 1e-9 * numeric[i].norm()) << "block " << i;
  }
}

/// A body that turns about gravity at a constant rate has a constant rate and force, so the shift is exact.
TEST(ImuFactor, IsZeroForStatesAtExposuresThatAreNotTheEndsOfThePreintegration) {
  const Eigen::Vector3d rate(0.0, 0.0, 0.8);
  const Eigen::Vector3d force(0.0, 0.0, 9.81);
  Preintegration imu(ImuNoise{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 20; ++i) samples.push_back({from_seconds(0.005 * i), rate, force});
  imu.integrate(samples);
  const auto state_at = [&](double t) {
    return Blocks{pose_block({0.3 * t, -0.1 * t, 0.0}, t * rate), {0.3, -0.1, 0.0, 0, 0, 0, 0, 0, 0}};
  };
  const TimedImuResidual::Ends ends = {ImuEnd{0.01, rate, force}, ImuEnd{-0.02, rate, force}};
  Blocks blocks = state_at(0.03);  // the time offset is 0.04, the preintegration starts at 0
  const Blocks last = state_at(0.16);
  blocks.insert(blocks.end(), last.begin(), last.end());
  blocks.push_back({kGravity.x(), kGravity.y(), kGravity.z()});
  blocks.push_back({0.04});
  EXPECT_LT(residual_at(ImuFactor(imu, ends), blocks).norm(), 1e-6);
}

TEST(ImuFactor, IsZeroForTheMeasuredMotion) {
  const Preintegration imu = rotating_motion();
  NavState start;
  start.T_w_b = Pose{exp_so3({0.1, -0.4, 0.9}), {1.0, 2.0, 3.0}};
  start.v_w = {0.5, -0.2, 0.1};
  start.gyro_bias = imu.gyro_bias();
  start.accel_bias = imu.accel_bias();
  const NavState end = imu.predict(start, kGravity);
  const auto state_blocks = [](const NavState& s) {
    const Pose& T = s.T_w_b;
    return Blocks{{T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()},
                  {s.v_w.x(), s.v_w.y(), s.v_w.z(), s.gyro_bias.x(), s.gyro_bias.y(), s.gyro_bias.z(),
                   s.accel_bias.x(), s.accel_bias.y(), s.accel_bias.z()}};
  };
  Blocks blocks = state_blocks(start);
  const Blocks last = state_blocks(end);
  blocks.insert(blocks.end(), last.begin(), last.end());
  blocks.push_back({kGravity.x(), kGravity.y(), kGravity.z()});
  blocks.push_back({0.0});
  EXPECT_LT(residual_at(ImuFactor(imu), blocks).norm(), 1e-6);  // standard deviations
}

}  // namespace
}  // namespace stillpoint
