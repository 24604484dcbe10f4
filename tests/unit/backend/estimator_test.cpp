// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "tests/support/simulated_flight.h"
#include "tests/support/take_in.h"

namespace stillpoint {
namespace {

constexpr double kRate_hz = 30.0;

struct Flown {
  double position_rmse_m = 0.0;  ///< after aligning the last pose is not done: the first pose is the anchor
  double first_pose_s = -1.0;
  double time_offset_s = 0.0;
  int poses = 0;
  NavState last;
};

/// Poses relative to the first reported one, against the truth relative to the same moment.
Flown fly(const SimulatedFlight& flight, const BackendConfig& backend, const ImuConfig& imu_config,
          double seconds) {
  Rig rig = SimulatedFlight::rig();
  rig.imu_noise = flight.imu_noise;
  Estimator estimator(backend, imu_config, rig, 1);
  const std::vector<ImuSample> imu = flight.imu(seconds + 0.5);
  std::size_t next = 0;
  Flown flown;
  std::optional<Pose> T_first, T_first_true;
  double squared = 0.0;
  for (int i = 0; i < static_cast<int>(seconds * kRate_hz); ++i) {
    const double t = 0.1 + i / kRate_hz;
    for (; next < imu.size() && to_seconds(imu[next].t) < t + 0.05; ++next) estimator.add_imu(imu[next]);
    const OdometryUpdate update = take_in(estimator, flight.picture(i, t));
    if (update.status != OdometryStatus::kTracking) continue;
    const Pose truth = SimulatedFlight::state(t + flight.time_offset_s).T_w_b;
    if (!T_first) {
      T_first = update.state.T_w_b;
      T_first_true = truth;
      flown.first_pose_s = t - 0.1;
    }
    const Pose moved = T_first->inverse() * update.state.T_w_b;
    const Pose moved_true = T_first_true->inverse() * truth;
    squared += (moved.p - moved_true.p).squaredNorm();
    ++flown.poses;
    flown.last = update.state;
    flown.time_offset_s = update.time_offset_s;
  }
  flown.position_rmse_m = std::sqrt(squared / flown.poses);
  return flown;
}

BackendConfig every_picture() {
  BackendConfig config;
  config.rate_hz = 0.0;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  return config;
}

TEST(Estimator, FollowsAnExactFlight) {
  const Flown flown = fly(SimulatedFlight{}, every_picture(), {}, 5.0);
  EXPECT_LT(flown.first_pose_s, 0.4);
  EXPECT_LT(flown.position_rmse_m, 0.002);
}

TEST(Estimator, FollowsANoisyFlightAndFindsItsBiases) {
  const SimulatedFlight flight{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true};
  const Flown flown = fly(flight, every_picture(), {}, 10.0);
  EXPECT_LT(flown.position_rmse_m, 0.03);
  EXPECT_LT((flown.last.gyro_bias - Eigen::Vector3d::Constant(0.02)).norm(), 0.005);
}

TEST(Estimator, FollowsWithoutAnImu) {
  const SimulatedFlight flight{.pixel_noise_px = 0.3, .depth_noise = 0.003};
  ImuConfig no_imu;
  no_imu.enabled = false;
  const Flown flown = fly(flight, every_picture(), no_imu, 5.0);
  EXPECT_EQ(flown.first_pose_s, 0.0);
  EXPECT_LT(flown.position_rmse_m, 0.03);
}

TEST(Estimator, FollowsWithDepthHeldFixedAtTheBackendRateOfThePaper) {
  BackendConfig config;
  const Flown flown = fly(SimulatedFlight{.pixel_noise_px = 0.3, .depth_noise = 0.001}, config, {}, 5.0);
  EXPECT_LT(flown.position_rmse_m, 0.03);
}

TEST(Estimator, FindsTheTimeOffset) {
  BackendConfig config = every_picture();
  config.time_offset_sigma_s = 0.05;
  const Flown flown = fly(SimulatedFlight{.pixel_noise_px = 0.2, .time_offset_s = 0.008}, config, {}, 8.0);
  EXPECT_NEAR(flown.time_offset_s, 0.008, 0.002);
}

TEST(Estimator, IsTheSameTwice) {
  const SimulatedFlight flight{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true};
  const Flown first = fly(flight, every_picture(), {}, 2.0);
  const Flown second = fly(flight, every_picture(), {}, 2.0);
  EXPECT_EQ(first.last.T_w_b.p, second.last.T_w_b.p);
  EXPECT_EQ(first.last.T_w_b.q.coeffs(), second.last.T_w_b.q.coeffs());
}

BackendConfig monocular() {
  BackendConfig config = every_picture();
  config.rate_hz = 10.0;
  config.depth.usage = DepthUsage::kOff;
  config.initializer.kind = InitializerKind::kMonocular;
  return config;
}

TEST(Estimator, FollowsWithoutDepthAndFindsTheScale) {
  const SimulatedFlight flight{.pixel_noise_px = 0.3};
  const Flown flown = fly(flight, monocular(), {}, 8.0);
  EXPECT_LT(flown.first_pose_s, 2.0);
  // The flight swings through 0.8 m: 0.03 m are what is allowed with noisy depth.
  EXPECT_LT(flown.position_rmse_m, 0.03);
}

TEST(Estimator, ReadsNoDepthWhenItIsOff) {
  // Depths that are wrong by a factor of about two change nothing, to the bit.
  const Flown right = fly({.pixel_noise_px = 0.3}, monocular(), {}, 3.0);
  const Flown wrong =
      fly({.pixel_noise_px = 0.3, .depth_noise = 0.0, .depth_factor = 2.0}, monocular(), {}, 3.0);
  EXPECT_EQ(right.last.T_w_b.p, wrong.last.T_w_b.p);
  EXPECT_GT(right.poses, 0);
}

TEST(Estimator, RefusesConfigurationsThatLeaveTheScaleUnknown) {
  BackendConfig no_depth = every_picture();
  no_depth.depth.usage = DepthUsage::kOff;
  EXPECT_THROW(Estimator(no_depth, {}, SimulatedFlight::rig(), 1), InputError);
  ImuConfig no_imu;
  no_imu.enabled = false;
  EXPECT_THROW(Estimator(monocular(), no_imu, SimulatedFlight::rig(), 1), InputError);
}

TEST(Estimator, RefusesAMonocularStartWithDepth) {
  BackendConfig config = monocular();
  config.depth.usage = DepthUsage::kWeighted;
  EXPECT_THROW(Estimator(config, {}, SimulatedFlight::rig(), 1), InputError);
}

TEST(Estimator, RefusesARigWithoutTheImuItNeeds) {
  Rig rig = SimulatedFlight::rig();
  rig.has_imu = false;
  EXPECT_THROW(Estimator(every_picture(), {}, rig, 1), InputError);
}

}  // namespace
}  // namespace stillpoint
