// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_scores.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

/// 1 m/s along x for 2 s; `error_m` further along y in every second block of 0.1 s.
Trajectory alternating(double interval_s, double error_m) {
  Trajectory trajectory{.frame = "camera", .poses = {}};
  for (int i = 0; i * interval_s < 2.0; ++i) {
    const double t = i * interval_s;
    const bool shifted = static_cast<int>(t / 0.1 + 1e-6) % 2 == 1;
    trajectory.poses.push_back(
        {from_seconds(t), {Eigen::Quaterniond::Identity(), {t, shifted ? error_m : 0.0, 0.0}}});
  }
  return trajectory;
}

TEST(ImuRateScore, ComparesShortIntervalsAtImuRateAndAtFrameRate) {
  const Trajectory gt = alternating(0.005, 0.0);
  ImuRateOutput output;
  output.trajectory = alternating(0.005, 0.02);
  const ImuRateScore score = score_imu_rate(gt, output, alternating(0.1, 0.0));
  // Poses 0.1 s apart are in different blocks, poses 1 s apart in equal ones.
  EXPECT_NEAR(score.rpe_100ms_m.value(), 0.02, 1e-9);
  EXPECT_NEAR(score.rpe_m_per_s.value(), 0.0, 1e-9);
  EXPECT_NEAR(score.frame_rate_rpe_100ms_m.value(), 0.0, 1e-9);
  EXPECT_NEAR(score.rpe_100ms_deg.value(), 0.0, 1e-9);
  // Half of the positions are 0.02 m beside the others, hence 0.01 m beside their mean.
  EXPECT_NEAR(score.ate_m.value(), 0.01, 1e-4);
  EXPECT_FALSE(score.step_p95_m.has_value());
}

TEST(ImuRateScore, SummarizesStepsAndAges) {
  ImuRateOutput output;
  for (int i = 0; i <= 100; ++i) {
    output.corrections.push_back({.translation_m = 0.001 * i, .rotation_deg = 0.01 * i});
    output.ages_ms.push_back(i);
  }
  const ImuRateScore score = score_imu_rate({}, output, {});
  EXPECT_NEAR(score.step_p95_m.value(), 0.095, 1e-12);
  EXPECT_NEAR(score.step_max_m.value(), 0.1, 1e-12);
  EXPECT_NEAR(score.step_p95_deg.value(), 0.95, 1e-12);
  EXPECT_NEAR(score.age_p95_ms.value(), 95.0, 1e-12);
  EXPECT_FALSE(score.ate_m.has_value());
}

}  // namespace
}  // namespace stillpoint::bench
