// SPDX-License-Identifier: BSD-3-Clause
#include "eval/score.h"

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::eval {
namespace {

std::optional<Timestamp> start_of(const Trajectory& gt, const ScoreOptions& options) {
  if (!options.expected_times.empty()) return options.expected_times.front();
  if (!gt.poses.empty()) return gt.poses.front().t;
  return std::nullopt;
}

}  // namespace

Score score(const Trajectory& gt, const Trajectory& est, const ScoreOptions& options) {
  Score result;
  result.poses = est.poses.size();
  const AssociationOptions association{.max_difference_s = options.max_difference_s,
                                       .offset_s = options.offset_s};
  if (const std::optional<AteResult> absolute = ate(gt, est, association)) {
    result.ate_rmse_m = absolute->translation_m.rmse;
    result.ate_pairs = absolute->pairs;
  }
  const RpeOptions relative_options{.delta = options.rpe_delta_s, .offset_s = options.offset_s};
  if (const std::optional<RpeResult> relative = rpe(gt, est, relative_options)) {
    result.rpe_trans_rmse_m_per_s = relative->translation_m.rmse / options.rpe_delta_s;
    result.rpe_rot_rmse_deg_per_s = relative->rotation_deg.rmse / options.rpe_delta_s;
    result.rpe_pairs = relative->translation_m.count;
  }
  result.correct_rate = correct_rate(gt, est, options.correct, options.offset_s);
  result.coverage = coverage(est, options.expected_times, options.coverage_tolerance_s);
  if (const std::optional<Timestamp> start = start_of(gt, options)) {
    result.first_pose_s = first_pose_seconds(est, *start);
  }
  return result;
}

}  // namespace stillpoint::eval
