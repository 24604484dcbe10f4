// SPDX-License-Identifier: BSD-3-Clause
// Reactions of the estimator to single faults, over seeds of the noise. The number of seeds is that of the
// environment (2 by default); scripts/fault_scenarios.sh runs ten and prints the values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

#include <fmt/format.h>

#include "core/geometry/covariance.h"
#include "core/imu/propagation.h"
#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

int seeds() {
  const char* text = std::getenv("STILLPOINT_FAULT_SEEDS");
  return text == nullptr ? 2 : std::stoi(text);
}

/// The runs of one scenario with different noise; prints the value that `measure` returns for each.
template <class Measure>
void for_each_seed(const char* name, FaultyScenario scenario, const Measure& measure) {
  std::string values;
  for (int seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    scenario.motion.seed = static_cast<std::uint32_t>(seed);
    values += fmt::format(" {:.3f}", measure(run_with_faults(scenario)));
  }
  std::cout << name << ':' << values << '\n';
}

int frames_in(const FaultyRun& run, double begin, double end) {
  return run.count(begin, end, [](const FaultyFrame&) { return true; });
}

void expect_no_lost_pose(const FaultyRun& run) {
  EXPECT_EQ(run.count_located(0.5, kEnd_s), frames_in(run, 0.5, kEnd_s));
}

double rms_error_m(const FaultyRun& run) {
  double squared = 0.0;
  int count = 0;
  for (const FaultyFrame& frame : run.frames) {
    if (!is_located(frame.update.status)) continue;
    squared += frame.error_m * frame.error_m;
    ++count;
  }
  return std::sqrt(squared / count);
}

/// Error of the first located frame from `t` on.
double error_at_return_m(const FaultyRun& run, double t) {
  for (const FaultyFrame& frame : run.frames) {
    if (frame.t >= t && is_located(frame.update.status)) return frame.error_m;
  }
  return INFINITY;
}

struct BlankCase {
  double seconds;
  double max_error_m;
};

/// Error at the return of the view. @param continued whether its features are recognized
void expect_return(const BlankCase& blanked, bool continued) {
  FaultyScenario scenario;
  const double end = kBegin_s + blanked.seconds;
  scenario.change_frame = blank(kBegin_s, end, continued);
  const std::string name = fmt::format("error after {} s of blank images, {} view [m]", blanked.seconds,
                                       continued ? "same" : "another");
  for_each_seed(name.c_str(), scenario, [&](const FaultyRun& run) {
    EXPECT_EQ(run.count_located(kBegin_s + 0.01, end - 0.01), 0);
    EXPECT_EQ(run.count_located(end + 0.05, kEnd_s), frames_in(run, end + 0.05, kEnd_s));
    EXPECT_EQ(run.frames.back().update.segment, 0);
    EXPECT_LE(error_at_return_m(run, end), blanked.max_error_m);
    return error_at_return_m(run, end);
  });
}

TEST(FaultScenarios, TheErrorAtTheReturnOfTheViewIsSmall) {
  for (const BlankCase& blanked : {BlankCase{0.2, 0.01}, BlankCase{1.0, 0.05}, BlankCase{5.0, 0.5}})
    expect_return(blanked, true);
}

TEST(FaultScenarios, TheErrorInAnotherViewIsThatOfDeadReckoning) {
  for (const BlankCase& blanked : {BlankCase{0.2, 0.01}, BlankCase{1.0, 0.05}, BlankCase{5.0, 0.5}})
    expect_return(blanked, false);
}

/// Error after dead reckoning from the true state with the true biases: that of the noise of the samples.
double error_of_noise_m(const SimulatedMotion& motion, double begin, double end) {
  NavState start = SimulatedMotion::state(begin);
  start.gyro_bias = motion.gyro_bias;
  start.accel_bias = motion.accel_bias;
  ImuBuffer imu;
  for (const ImuSample& sample : motion.imu(end + 0.5)) imu.add(sample);
  const NavState reached =
      propagate(start, imu.samples_between(from_seconds(begin), from_seconds(end)), {0.0, 0.0, -9.81});
  return (reached.T_w_b.p - SimulatedMotion::state(end).T_w_b.p).norm();
}

/// The last frame before the view returns: vision then corrects the motion of the previous frames, too.
TEST(FaultScenarios, TheCovarianceCoversTheErrorOfDeadReckoning) {
  FaultyScenario scenario;
  const double end = kBegin_s + 5.0;
  scenario.change_frame = blank(kBegin_s, end, false);
  SimulatedMotion motion = scenario.motion;
  std::string noise;
  std::string sigmas;
  for_each_seed("error before the return after 5 s of blank images [m]", scenario, [&](const FaultyRun& run) {
    const auto returned = std::ranges::find_if(run.frames, [&](const FaultyFrame& f) { return f.t >= end; });
    const FaultyFrame& last = *std::prev(returned);
    EXPECT_EQ(last.update.status, kDeadReckoning);
    EXPECT_TRUE(last.update.covariance);
    const double sigma_m = largest_sigma(last.update.covariance->position());
    EXPECT_LE(last.error_m, 3.0 * sigma_m);
    ++motion.seed;  // from 1, as for_each_seed
    sigmas += fmt::format(" {:.3f}", sigma_m);
    noise += fmt::format(" {:.3f}", error_of_noise_m(motion, kBegin_s, last.t));
    return last.error_m;
  });
  std::cout << "claimed standard deviation [m]:" << sigmas
            << "\nerror by the noise of the samples [m]:" << noise << '\n';
}

TEST(FaultScenarios, AGapOfTheImuLosesNoPose) {
  FaultyScenario scenario;
  scenario.change_imu = imu_gap(kBegin_s, kBegin_s + 1.0);
  for_each_seed("largest error with an IMU gap of 1 s [m]", scenario, [](const FaultyRun& run) {
    expect_no_lost_pose(run);
    return run.worst_error_m(0.0, kEnd_s);
  });
}

TEST(FaultScenarios, AShockIsOverAfterTwoSeconds) {
  FaultyScenario scenario;
  scenario.change_imu = shock(kBegin_s, kBegin_s + 1.0, {8.0, 0.0, 0.0});
  for_each_seed("error of the accelerometer bias after a shock [m/s^2]", scenario, [](const FaultyRun& run) {
    EXPECT_EQ(run.count(7.0, kEnd_s, kTracking), frames_in(run, 7.0, kEnd_s));
    const Eigen::Vector3d bias = run.frames.back().update.state.accel_bias;
    const double error = (bias - Eigen::Vector3d::Constant(0.05)).norm();
    EXPECT_LE(error, 0.2);
    return error;
  });
}

TEST(FaultScenarios, ATimeOffsetLosesNoPose) {
  FaultyScenario scenario;
  scenario.motion.time_offset_s = 0.1;
  for_each_seed("largest error with a time offset of 0.1 s [m]", scenario, [](const FaultyRun& run) {
    expect_no_lost_pose(run);
    return run.worst_error_m(0.0, kEnd_s);
  });
}

TEST(FaultScenarios, AnImuAsSlowAsTheCameraIsAccurate) {
  FaultyScenario scenario;
  scenario.imu_rate_hz = 30.0;
  for_each_seed("ATE with an IMU at 30 Hz [m]", scenario, [](const FaultyRun& run) {
    EXPECT_LE(rms_error_m(run), 0.012);
    return rms_error_m(run);
  });
}

TEST(FaultScenarios, VisualOdometryIsLostAtOnceAndRelocated) {
  FaultyScenario scenario;
  scenario.uses_imu = false;
  scenario.change_frame = blank(kBegin_s, kBegin_s + 1.0, true);
  for_each_seed("largest error of visual odometry with 1 s of blank images [m]", scenario,
                [](const FaultyRun& run) {
                  EXPECT_EQ(run.count_located(kBegin_s + 0.2, kBegin_s + 0.99), 0);
                  EXPECT_EQ(run.count(kBegin_s + 0.99, kBegin_s + 1.05, kRelocated), 1);
                  EXPECT_EQ(run.frames.back().update.segment, 0);
                  return run.worst_error_m(0.0, kEnd_s);
                });
}

}  // namespace
}  // namespace stillpoint
