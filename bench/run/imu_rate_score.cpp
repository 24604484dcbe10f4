// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/imu_rate_score.h"

#include <algorithm>

#include "eval/metrics/strict_rpe.h"

namespace stillpoint::bench {
namespace {

constexpr double kShort_s = 0.1;

std::optional<eval::StrictRpe> rpe_over(const Trajectory& gt, const Trajectory& est, double delta_s) {
  return eval::strict_rpe(eval::strict_matches(gt, est), delta_s).errors;
}

std::vector<double> collect(const std::vector<PoseCorrection>& corrections, double PoseCorrection::*member) {
  std::vector<double> values;
  for (const PoseCorrection& correction : corrections) values.push_back(correction.*member);
  return values;
}

}  // namespace

ImuRateScore score_imu_rate(const Trajectory& gt, const ImuRateOutput& output, const Trajectory& frame_rate) {
  constexpr double kHigh = 0.95;
  const std::vector<double> steps_m = collect(output.corrections, &PoseCorrection::translation_m);
  ImuRateScore score;
  if (const std::optional<eval::AteResult> ate = eval::ate(gt, output.trajectory))
    score.ate_m = ate->translation_m.rmse;
  if (const auto rpe = rpe_over(gt, output.trajectory, kShort_s)) {
    score.rpe_100ms_m = rpe->translation_m.rmse;
    score.rpe_100ms_deg = rpe->rotation_deg.rmse;
  }
  if (const auto rpe = rpe_over(gt, output.trajectory, 1.0)) {
    score.rpe_m_per_s = rpe->translation_m.rmse;
    score.rpe_deg_per_s = rpe->rotation_deg.rmse;
  }
  if (const auto rpe = rpe_over(gt, frame_rate, kShort_s)) {
    score.frame_rate_rpe_100ms_m = rpe->translation_m.rmse;
    score.frame_rate_rpe_100ms_deg = rpe->rotation_deg.rmse;
  }
  score.step_p95_m = eval::percentile(steps_m, kHigh);
  score.step_max_m = eval::percentile(steps_m, 1.0);
  score.step_p95_deg = eval::percentile(collect(output.corrections, &PoseCorrection::rotation_deg), kHigh);
  score.age_p95_ms = eval::percentile(output.ages_ms, kHigh);
  return score;
}

}  // namespace stillpoint::bench
