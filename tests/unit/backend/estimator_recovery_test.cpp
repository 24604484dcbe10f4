// SPDX-License-Identifier: BSD-3-Clause
// What the estimator keeps and what it gives up after failures, on simulated motion: biases and prior.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

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

/// Bearings in [begin, end) s become `value`.
std::function<void(TrackedFrame&)> bearings_of(double value, double begin, double end) {
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t);
    if (t < begin || t >= end) return;
    for (TrackedFeature& feature : frame.features) feature.bearing.x() = value;
  };
}

struct BrokenFrame {
  double bearing;  ///< of all features
  double t;        ///< of the first of two frames [s]
  StatusReason reason;
};

/// Squares of the large bearings overflow: the cost is infinite, while states and prior stay finite. In the
/// second case, a frame becomes part of the prior before the third unusable solve.
TEST(EstimatorRecovery, UnusableSolvesAndAPriorThatIsNotFiniteAreALoss) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const BrokenFrame& broken : {BrokenFrame{1e200, 4.2, StatusReason::kSolveFailed},
                                    BrokenFrame{nan, 4.1, StatusReason::kDiverged}}) {
    FaultyScenario scenario;
    scenario.change_frame = bearings_of(broken.bearing, broken.t, broken.t + 0.04);
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count(broken.t, broken.t + 0.2,
                        [&](const FaultyFrame& frame) {
                          return frame.update.status == kLost && frame.update.reason == broken.reason;
                        }),
              1);
    EXPECT_EQ(run.count(5.0, kEnd_s, kTracking), run.count(5.0, kEnd_s, is_finite));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.02);
    EXPECT_EQ(run.frames.back().update.segment, 0);
  }
}

}  // namespace
}  // namespace stillpoint
