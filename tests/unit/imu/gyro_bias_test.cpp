// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/preintegration.h"

#include <gtest/gtest.h>

#include "tests/unit/imu/motions.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

TEST(GyroBias, IsRecoveredInTwoIterations) {
  const Eigen::Vector3d bias(0.05, -0.08, 0.03);
  std::vector<ImuSample> samples = rich_motion_samples(0.5);
  Preintegration clean(ImuNoise{}, kZero, kZero);
  clean.integrate(samples);
  for (ImuSample& sample : samples) sample.gyro_b += bias;
  Preintegration biased(ImuNoise{}, kZero, kZero);
  biased.integrate(samples);

  const std::vector<RotationPair> pairs{{&biased, clean.delta_q(kZero)}};
  const Eigen::Vector3d first = estimate_gyro_bias(pairs);
  EXPECT_LT((first - bias).norm(), 2.5e-3);  // second order: |bias|^2 T / 2 = 2.5e-3 rad/s
  biased.repropagate(first, kZero);
  EXPECT_LT((estimate_gyro_bias(pairs) - bias).norm(), 1.6e-6);  // (2.5e-3)^2 T / 2
}

}  // namespace
}  // namespace stillpoint
