// SPDX-License-Identifier: BSD-3-Clause
// The covariance of the estimate is that of its errors, and calibration converges to the truth. A few runs
// only: the limits are wide. scripts/nees.sh executes 50.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/published_config.h"
#include "tests/support/simulated/nees_simulation.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

/// Noise as simulated, so that the covariance can be compared with the errors.
OdometryConfig simulated_config(PriorModel prior) {
  OdometryConfig config = published_config();
  config.backend.rate_hz = 0.0;
  config.backend.solver = WindowSolverKind::kSchur;
  config.backend.gravity = GravityModel::kEstimated;
  config.backend.prior = prior;
  config.backend.covariance = true;
  config.backend.max_iterations = 4;
  config.backend.keyframe_max_interval_s = 0.5;
  config.backend.pixel_sigma_px = std::sqrt(2.0) * NeesDraw{}.pixel_noise_px;  // difference of two bearings
  config.backend.cauchy_scale = 3.0;
  config.backend.depth.usage = DepthUsage::kWeighted;
  config.backend.depth.outlier_sigmas = 5.0;
  config.backend.initializer.kind = InitializerKind::kInstant;
  config.backend.time_offset_walk = 1e-3;
  return config;
}

/// Mean over runs and checkpoints of the squared normalized error per dimension.
std::map<std::string, double> mean_nees(PriorModel prior, int runs) {
  std::map<std::string, double> sum;
  std::map<std::string, int> count;
  for (int i = 1; i <= runs; ++i) {
    const NeesDraw draw{.seed = static_cast<std::uint32_t>(i)};
    for (const auto& terms : simulate_nees(simulated_config(prior), draw, {4.0, 8.0, 12.0})) {
      for (const NeesTerm& term : terms) {
        sum[term.quantity] += term.squared / term.dimension;
        ++count[term.quantity];
      }
    }
  }
  for (auto& [quantity, value] : sum) value /= count[quantity];
  return sum;
}

TEST(EstimatorConsistency, TheConsistentPriorGivesTheCovarianceOfTheErrors) {
  const std::map<std::string, double> nees = mean_nees(PriorModel::kConsistent, 6);
  for (const char* quantity : {"position", "orientation", "velocity"}) {
    EXPECT_GT(nees.at(quantity), 0.5) << quantity;
    EXPECT_LT(nees.at(quantity), 1.6) << quantity;
  }
}

TEST(EstimatorConsistency, InnovationsHaveTheirCovariance) {
  const std::map<std::string, double> nees = mean_nees(PriorModel::kConsistent, 6);
  for (const char* quantity : {"NIS reprojection", "NIS inertial"}) {
    EXPECT_GT(nees.at(quantity), 0.6) << quantity;
    EXPECT_LT(nees.at(quantity), 1.5) << quantity;
  }
}

TEST(EstimatorConsistency, ThePublishedPriorIsOverconfidentInThePosition) {
  EXPECT_GT(mean_nees(PriorModel::kPublished, 6).at("position"), 2.0);
}

TEST(EstimatorConsistency, ConfiguredNoiseDensitiesReplaceThoseOfTheRig) {
  const ImuNoise stated = SimulatedMotion::rig().imu_noise;
  OdometryConfig scaled = simulated_config(PriorModel::kConsistent);
  scaled.imu.noise_scale = 3.0;
  OdometryConfig configured = simulated_config(PriorModel::kConsistent);
  configured.imu.gyro_noise = 3.0 * stated.gyro_noise;
  configured.imu.accel_noise = 3.0 * stated.accel_noise;
  configured.imu.gyro_walk = 3.0 * stated.gyro_walk;
  configured.imu.accel_walk = 3.0 * stated.accel_walk;
  const auto position = [](const OdometryConfig& config) {
    return simulate_nees(config, {}, {3.0}).at(0).at(0).squared;
  };
  EXPECT_EQ(position(configured), position(scaled));
  EXPECT_NE(position(configured), position(simulated_config(PriorModel::kConsistent)));
}

TEST(EstimatorConsistency, ATimeOffsetFarFromTheCalibratedOneIsFound) {
  OdometryConfig config = simulated_config(PriorModel::kConsistent);
  config.backend.time_offset_sigma_s = 0.05;
  for (const double true_s : {-0.04, 0.04}) {
    const auto terms = simulate_nees(config, {.time_offset_s = true_s}, {15.0}).back();
    for (const NeesTerm& term : terms) {
      if (term.quantity != "time offset") continue;
      EXPECT_LT(term.error, 0.004) << true_s;
    }
  }
}

}  // namespace
}  // namespace stillpoint
