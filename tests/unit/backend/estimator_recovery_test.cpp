// SPDX-License-Identifier: BSD-3-Clause
// What the estimator keeps and what it gives up after failures, on simulated motion: the map of trusted
// landmarks, biases, prior.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

/// No features in [begin, end) s; then the same landmarks, moved by `shift_w`.
std::function<void(TrackedFrame&)> blank_while_landmarks_move(double begin, double end,
                                                              const Eigen::Vector3d& shift_w) {
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t);
    if (t >= begin && t < end) frame.features.clear();
    if (t < end) return;
    const Pose T_w_c = SimulatedMotion::state(t).T_w_b * SimulatedMotion::rig().T_b_c;
    for (TrackedFeature& feature : frame.features) {
      const Eigen::Vector3d p_c =
          feature.depth * Eigen::Vector3d(feature.bearing.homogeneous()) + T_w_c.q.conjugate() * shift_w;
      feature.bearing = p_c.hnormalized();
      feature.depth = p_c.z();
    }
  };
}

/// After 1 s, dead reckoning errs by at most 0.032 m in ten runs (scripts/fault_scenarios.sh).
TEST(EstimatorRecovery, AMapThatMovedDoesNotReplaceDeadReckoning) {
  FaultyScenario scenario;
  scenario.change_frame = blank_while_landmarks_move(kBegin_s, kBegin_s + 1.0, {0.0, 0.25, 0.0});
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count(0.0, kEnd_s, kRelocated), 0);
  EXPECT_EQ(run.count_located(5.1, kEnd_s), run.count(5.1, kEnd_s, is_finite));
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.06);
}

/// Few recognized features with large errors give a worse pose than 0.3 s of dead reckoning.
TEST(EstimatorRecovery, AnInaccurateMapPoseDoesNotReplaceDeadReckoning) {
  FaultyScenario scenario;
  const double end = kBegin_s + 0.3;
  scenario.change_frame = [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t);
    if (t >= kBegin_s && t < end) frame.features.clear();
    if (t < end) return;
    Random random(static_cast<std::uint32_t>(frame.id));
    int kept = 0;
    for (TrackedFeature& feature : frame.features) {
      const bool recognized = t < end + 0.04 && kept < 16;
      if (recognized) feature.bearing += 0.005 * random.normal2();
      if (recognized) ++kept;
      if (!recognized) feature.id += 100000;
    }
  };
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.02);
}

TEST(EstimatorRecovery, ADivergedBiasIsForgotten) {
  FaultyScenario scenario;
  scenario.motion.imu_noise.accel_walk = 0.5;  // so that the bias follows
  scenario.change_imu = [](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) {
      const double t = to_seconds(sample.t);
      if (t >= kBegin_s && t < 8.0) sample.accel_b.x() += 0.8 * (t - kBegin_s);
    }
  };
  const FaultyRun run = run_with_faults(scenario);
  int resets = 0;
  for (const FaultyFrame& frame : run.frames) {
    if (!frame.update.counters.reset) continue;
    ++resets;
    EXPECT_EQ(frame.update.state.accel_bias.norm(), 0.0) << frame.t;
  }
  EXPECT_GT(resets, 0);
}

double claimed_sigma_m(const FaultyFrame& frame) {
  return std::sqrt(frame.update.covariance->position().trace());
}

/// Of the last located frame before a time and of the first one after it that claim a covariance.
struct ClaimsAround {
  double before_m = 0.0, after_m = 0.0;
};

ClaimsAround claims_around(const FaultyRun& run, double t) {
  ClaimsAround claims;
  for (const FaultyFrame& frame : run.frames) {
    if (!is_located(frame.update.status) || !frame.update.covariance) continue;
    if (frame.t < t) claims.before_m = claimed_sigma_m(frame);
    if (frame.t >= t && claims.after_m == 0.0) claims.after_m = claimed_sigma_m(frame);
  }
  return claims;
}

/// The landmarks of the map have the error of the poses that they were seen from.
TEST(EstimatorRecovery, APoseOnTheMapClaimsTheErrorOfTheMap) {
  for (const bool uses_imu : {true, false}) {
    FaultyScenario scenario;
    scenario.uses_imu = uses_imu;
    use_consistent_prior(scenario.backend);
    scenario.change_frame = blank(kBegin_s, kBegin_s + 5.0, true);
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count(8.9, 9.1, kRelocated), 1);
    const ClaimsAround claims = claims_around(run, kBegin_s);
    EXPECT_GT(claims.before_m, 0.002);
    EXPECT_GE(claims.after_m, claims.before_m) << uses_imu;
  }
}

/// Bearings in [begin, end) s become `value`.
std::function<void(TrackedFrame&)> bearings_of(double value, double begin, double end) {
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t);
    if (t < begin || t >= end) return;
    for (TrackedFeature& feature : frame.features) feature.bearing.x() = value;
  };
}

/// Squares of the large bearings of two frames overflow: the cost is infinite, while the states stay finite.
TEST(EstimatorRecovery, UnusableSolvesAreALoss) {
  FaultyScenario scenario;
  scenario.change_frame = bearings_of(1e200, 4.2, 4.24);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count(4.2, 4.4,
                      [](const FaultyFrame& frame) {
                        return frame.update.status == kLost &&
                               frame.update.reason == StatusReason::kSolveFailed;
                      }),
            1);
  EXPECT_EQ(run.count(5.0, kEnd_s, kTracking), run.count(5.0, kEnd_s, is_finite));
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.02);
  EXPECT_EQ(run.frames.back().update.segment, 0);
  const ClaimsAround claims = claims_around(run, 4.2);
  EXPECT_GE(claims.after_m, claims.before_m);
}

}  // namespace
}  // namespace stillpoint
