// SPDX-License-Identifier: BSD-3-Clause
// Compares the preintegrated covariance with the sample covariance of many noisy runs.
#include <random>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "core/imu/preintegration.h"
#include "tests/unit/imu/motions.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();
constexpr double kRateHz = 200.0;
// Large random walks, so that they affect p, theta and v within half a second.
const ImuNoise kNoise{.gyro_noise = 2e-3, .accel_noise = 2e-2, .gyro_walk = 5e-3, .accel_walk = 5e-2};

class NoiseSource {
 public:
  explicit NoiseSource(unsigned seed) : generator_(seed) {}
  Eigen::Vector3d draw(double sigma) {
    const double z = normal_(generator_), y = normal_(generator_), x = normal_(generator_);
    return sigma * Eigen::Vector3d(x, y, z);
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

/// `clean` with added noise, and the final biases. White noise of density s has the standard deviation
/// s / sqrt(dt) per sample; the random walk adds s * sqrt(dt) from each sample to the next.
struct NoisyRun {
  std::vector<ImuSample> samples;
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
};
NoisyRun noisy_run(const std::vector<ImuSample>& clean, NoiseSource& noise) {
  const double root_dt = std::sqrt(1.0 / kRateHz);
  NoisyRun run{.samples = clean};
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (i > 0) {
      run.gyro_bias += noise.draw(kNoise.gyro_walk * root_dt);
      run.accel_bias += noise.draw(kNoise.accel_walk * root_dt);
    }
    run.samples[i].gyro_b += run.gyro_bias + noise.draw(kNoise.gyro_noise / root_dt);
    run.samples[i].accel_b += run.accel_bias + noise.draw(kNoise.accel_noise / root_dt);
  }
  return run;
}

/// True minus measured, in the order and sign convention of the error state.
Vector15 error_of(const NoisyRun& run, const Preintegration& truth) {
  Preintegration measured(kNoise, kZero, kZero);
  measured.integrate(run.samples);
  Vector15 error;
  error.segment<3>(0) = truth.delta_p(kZero, kZero) - measured.delta_p(kZero, kZero);
  error.segment<3>(3) = log_so3(measured.delta_q(kZero).conjugate() * truth.delta_q(kZero));
  error.segment<3>(6) = truth.delta_v(kZero, kZero) - measured.delta_v(kZero, kZero);
  error.segment<3>(9) = run.gyro_bias;
  error.segment<3>(12) = run.accel_bias;
  return error;
}

TEST(PreintegrationCovariance, MatchesTheSampleCovarianceOfNoisyRuns) {
  constexpr int kRuns = 1500;
  const std::vector<ImuSample> clean = rich_motion_samples(0.5, kRateHz);
  Preintegration truth(kNoise, kZero, kZero);
  truth.integrate(clean);

  NoiseSource noise(7);
  Matrix15 spread = Matrix15::Zero();
  for (int i = 0; i < kRuns; ++i) {
    const Vector15 error = error_of(noisy_run(clean, noise), truth);
    spread += error * error.transpose() / kRuns;
  }
  // Whitened by the predicted covariance, the sample covariance must be the identity. With 1500 runs its
  // entries have a standard deviation of sqrt(2 / 1500) = 0.037 on the diagonal and 0.026 elsewhere; 225
  // entries: 4.5 sigma. The noise model is off by half a sample in 100 (the end samples have half weight):
  // 0.005.
  const Matrix15 L = truth.covariance().llt().matrixL();
  const Matrix15 left = L.triangularView<Eigen::Lower>().solve(spread);
  const Matrix15 whitened = L.triangularView<Eigen::Lower>().solve(left.transpose());
  for (int row = 0; row < 15; ++row) {
    EXPECT_NEAR(whitened(row, row), 1.0, 4.5 * 0.037 + 0.005) << "row " << row;
    for (int col = 0; col < row; ++col)
      EXPECT_NEAR(whitened(row, col), 0.0, 4.5 * 0.026) << row << " " << col;
  }
}

TEST(PreintegrationCovariance, AccumulatesDensitySquaredTimesTime) {
  const ImuNoise white{.gyro_noise = 2e-3, .accel_noise = 2e-2, .gyro_walk = 1e-4, .accel_walk = 1e-3};
  Preintegration imu(white, kZero, kZero);
  imu.integrate(sample_motion(0.5, kRateHz, [](double) { return ImuSample{}; }));
  // At rest without gravity: theta variance = s^2 T, plus walk s_w^2 T^3 / 3 (0.01 % here).
  EXPECT_NEAR(imu.covariance()(3, 3), 4e-6 * 0.5, 2e-9);
  EXPECT_NEAR(imu.covariance()(6, 6), 4e-4 * 0.5, 2e-7);
  EXPECT_NEAR(imu.covariance()(9, 9), 1e-8 * 0.5, 1e-20);
  EXPECT_NEAR(imu.covariance()(12, 12), 1e-6 * 0.5, 1e-18);
}

TEST(PreintegrationCovariance, IsNearlyIndependentOfTheSampleRate) {
  Preintegration slow(kNoise, kZero, kZero);
  Preintegration fast(kNoise, kZero, kZero);
  slow.integrate(rich_motion_samples(0.5, 100.0));
  fast.integrate(rich_motion_samples(0.5, 400.0));
  const Eigen::Array<double, 15, 1> ratio =
      slow.covariance().diagonal().array() / fast.covariance().diagonal().array();
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 0.03);  // per-sample sigmas would give a factor of 4
}

TEST(PreintegrationCovariance, StaysSymmetricAndPositive) {
  Preintegration imu(kNoise, kZero, kZero);
  imu.integrate(rich_motion_samples(5.0));
  EXPECT_LT((imu.covariance() - imu.covariance().transpose()).norm(), 1e-12 * imu.covariance().norm());
  EXPECT_EQ(imu.covariance().llt().info(), Eigen::Success);
}

}  // namespace
}  // namespace stillpoint
