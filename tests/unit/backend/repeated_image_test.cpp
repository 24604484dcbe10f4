// SPDX-License-Identifier: BSD-3-Clause
// A camera that repeats an image, without an IMU, on simulated motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

/// The camera repeats the last image before `begin` until `end`: frames without features.
std::function<void(TrackedFrame&)> repeat_image(double begin, double end) {
  return [=](TrackedFrame& frame) {
    frame.repeated = to_seconds(frame.t) >= begin && to_seconds(frame.t) < end;
    if (frame.repeated) frame.features.clear();
  };
}

TEST(RepeatedImage, IsBridgedByConstantVelocityWithoutAnImu) {
  FaultyScenario scenario;
  scenario.uses_imu = false;
  scenario.change_frame = repeat_image(3.99, 4.02);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count(0.5, kEnd_s, kTracking) + 1, run.count(0.5, kEnd_s, is_finite));
  const auto bridged = std::ranges::find_if(run.frames, [](const FaultyFrame& frame) {
    return frame.update.reason == StatusReason::kRepeatedImage;
  });
  ASSERT_NE(bridged, run.frames.end());
  EXPECT_NEAR(bridged->t, 4.0, 0.001);
  EXPECT_EQ(bridged->update.status, kDegraded);
  EXPECT_NEAR(to_seconds(bridged->update.state.t), bridged->t, 1e-6);
  ASSERT_TRUE(bridged->update.covariance);
  const OdometryUpdate& before = std::prev(bridged)->update;
  const double sigma_m = std::sqrt(bridged->update.covariance->position().trace());
  const double before_m = std::sqrt(before.covariance->position().trace());
  const double motion_m = (bridged->update.state.T_w_b.p - before.state.T_w_b.p).norm();
  EXPECT_GT(sigma_m, std::hypot(before_m, motion_m));  // the camera may have stopped as well
  EXPECT_LT(bridged->error_m, sigma_m);
}

TEST(RepeatedImage, IsLostWithoutAnImuIfTheCameraIsFrozen) {
  FaultyScenario scenario;
  scenario.uses_imu = false;
  scenario.change_frame = repeat_image(3.99, 5.0);
  EXPECT_EQ(run_with_faults(scenario).count_located(3.99, 4.99), 3);  // 0.12 s at 30 Hz
  EXPECT_LT(run_with_faults(scenario).worst_error_m(0.0, kEnd_s), 0.05);
  scenario.backend.covariance = false;  // no pose of unknown uncertainty
  EXPECT_EQ(run_with_faults(scenario).count_located(3.99, 4.99), 0);
}

}  // namespace
}  // namespace stillpoint
