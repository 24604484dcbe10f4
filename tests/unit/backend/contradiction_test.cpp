// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/bias_monitor.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr Timestamp kMeasured{10'000'000'000};

/// An error of 0.4 m/s^2 and 0.02 rad/s.
MeasuredBiases measured_at(Timestamp t) {
  return {.t = t, .gyro = {0.0, 0.0, 0.02}, .accel = {0.0, 0.4, 0.0}};
}

double sigma_m_after(const Contradiction& contradiction, double seconds) {
  StateCovariance covariance;
  contradiction.add_to(covariance, after(kMeasured, seconds));
  return std::sqrt(covariance.state(0, 0));
}

TEST(Contradiction, AddsTheMotionThatTheErrorsCause) {
  Contradiction contradiction;
  StateCovariance covariance;
  contradiction.add_to(covariance, kMeasured);
  EXPECT_TRUE(covariance.state.isZero(0.0));

  contradiction.begin_or_continue(measured_at(kMeasured), {});
  contradiction.add_to(covariance, kMeasured);  // the measurement began 0.48 s before
  EXPECT_NEAR(std::sqrt(covariance.state(1, 1)), 0.5 * 0.4 * 0.48 * 0.48, 1e-9);
  EXPECT_NEAR(std::sqrt(covariance.state(4, 4)), 0.02 * 0.48, 1e-9);
  EXPECT_NEAR(std::sqrt(covariance.state(7, 7)), 0.4 * 0.48, 1e-9);
  EXPECT_EQ(covariance.state(9, 9), 0.0);
}

TEST(Contradiction, GrowsForOneSecondAtMost) {
  Contradiction contradiction;
  for (int i = 0; i <= 8; ++i) contradiction.begin_or_continue(measured_at(after(kMeasured, 0.12 * i)), {});
  EXPECT_NEAR(sigma_m_after(contradiction, 0.96), 0.5 * 0.4, 1e-9);
}

TEST(Contradiction, EndsByAgreementOrWithoutFurtherChecks) {
  Contradiction contradiction;
  contradiction.begin_or_continue(measured_at(kMeasured), {});
  EXPECT_TRUE(contradiction.holds_at(after(kMeasured, 0.29)));
  EXPECT_FALSE(contradiction.holds_at(after(kMeasured, 0.31)));
  EXPECT_EQ(sigma_m_after(contradiction, 0.31), 0.0);
  contradiction.end();
  EXPECT_FALSE(contradiction.holds_at(kMeasured));
}

/// The error is that of the biases of the state.
TEST(Contradiction, ComparesWithTheEstimatedBiases) {
  Contradiction contradiction;
  contradiction.begin_or_continue(measured_at(kMeasured),
                                  {.gyro_bias = {0.0, 0.0, 0.02}, .accel_bias = {0.0, 0.4, 0.0}});
  EXPECT_EQ(sigma_m_after(contradiction, 0.0), 0.0);
}

}  // namespace
}  // namespace stillpoint
