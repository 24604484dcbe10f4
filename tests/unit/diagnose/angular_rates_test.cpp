// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/angular_rates.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/diagnose/turning_rig.h"

namespace stillpoint::bench {
namespace {

TEST(FitRotation, FindsTheRotationBetweenTwoSensors) {
  const Eigen::Quaterniond q_b_c(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  const TurningRig rig({.q_b_c = q_b_c});
  const datasets::RotationFit fit = fit_rotation(rate_pairs(datasets::RateIntegral(rig.imu), rig.rates, 0.0));
  EXPECT_LT(fit.q_a_b.angularDistance(q_b_c), 1e-3);
  EXPECT_LT(fit.residual, 0.01);
  EXPECT_LT(fit.sigma_rad.maxCoeff(), 1e-3);
}

TEST(FitRotation, HasALargeDeviationAboutAnAxisThatIsNotObserved) {
  TurningRig rig({});
  for (ImuSample& sample : rig.imu) sample.gyro_b = {0.0, sample.gyro_b.y() + 0.01 * sample.gyro_b.x(), 0.0};
  for (datasets::RateInterval& interval : rig.rates) interval.rate = {0.0, interval.rate.y(), 0.0};
  const datasets::RotationFit fit = fit_rotation(rate_pairs(datasets::RateIntegral(rig.imu), rig.rates, 0.0));
  EXPECT_GT(fit.sigma_rad.y(), 1.0);
  EXPECT_LT(fit.sigma_rad.x(), 0.1);
}

TEST(FitLag, FindsALateSensorToAMillisecond) {
  const TurningRig rig({.lag_s = 0.023});
  const std::optional<datasets::LagFit> fit = fit_lag(datasets::RateIntegral(rig.imu), rig.rates, 0.2);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->lag_s, 0.023, 0.001);
  EXPECT_LT(fit->sigma_s, 0.002);
  EXPECT_LT(fit->residual, fit->without);
}

TEST(FitLag, HasNoResultWithoutACommonRotation) {
  TurningRig rig({});
  for (datasets::RateInterval& interval : rig.rates) interval.rate = Eigen::Vector3d(0.0, 0.0, 0.001);
  EXPECT_FALSE(fit_lag(datasets::RateIntegral(rig.imu), rig.rates, 0.2));
}

TEST(RateIntegral, HasNoRateAcrossAGap) {
  std::vector<ImuSample> samples;
  for (const double t : {0.0, 0.01, 0.02, 0.5, 0.51})
    samples.push_back({.t = from_seconds(t), .gyro_b = {1, 0, 0}});
  const datasets::RateIntegral integral(samples);
  EXPECT_TRUE(integral.mean(from_seconds(0.0), from_seconds(0.02)));
  EXPECT_FALSE(integral.mean(from_seconds(0.0), from_seconds(0.3)));
  EXPECT_FALSE(integral.mean(from_seconds(0.5), from_seconds(0.6)));
}

TEST(AxisPermutations, AreAllDifferentAndBeginWithTheIdentity) {
  const auto& all = datasets::axis_permutations();
  EXPECT_TRUE(all[0].isIdentity());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(std::abs(all[i].determinant()), 1.0, 1e-12);
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(all[i].isApprox(all[j]));
  }
  EXPECT_EQ(datasets::permutation_text(all[0]), "(x, y, z) <- (x, y, z)");
}

}  // namespace
}  // namespace stillpoint::bench
