// SPDX-License-Identifier: BSD-3-Clause
#include "eval/openloris/sequence_score.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "eval/metrics/ate.h"

namespace stillpoint::eval {
namespace {

constexpr double kRelocalizationScale = 60.0;  // [s]

std::optional<double> rmse(std::span<const double> values) {
  const std::optional<Statistics> summary = statistics(values);
  if (!summary) return std::nullopt;
  return summary->rmse;
}

/// Per match, whether it is correct.
std::vector<bool> correct_mask(const AteErrors& errors, const CorrectRateOptions& limits) {
  std::vector<bool> correct;
  for (std::size_t i = 0; i < errors.translation_m.size(); ++i) {
    correct.push_back(errors.translation_m[i] <= limits.max_translation_m &&
                      errors.rotation_deg[i] <= limits.max_rotation_deg);
  }
  return correct;
}

std::vector<double> select(std::span<const double> values, const std::vector<bool>& mask) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (mask[i]) result.push_back(values[i]);
  }
  return result;
}

std::vector<TrackedSpan> spans_of(std::span<const MatchedPose> matches, const std::vector<bool>& correct,
                                  const Trajectory& gt, double max_hold_s) {
  const Timestamp start = gt.poses.front().t;
  const Timestamp end = std::max(gt.poses.back().t, matches.back().t);
  std::vector<TrackedSpan> spans;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!correct[i]) continue;
    const double begin_s = seconds_between(start, matches[i].t);
    const double until_s = seconds_between(start, i + 1 < matches.size() ? matches[i + 1].t : end);
    const double end_s = std::min(until_s, begin_s + max_hold_s);
    if (!spans.empty() && begin_s <= spans.back().end_s) {
      spans.back().end_s = end_s;
    } else {
      spans.push_back({begin_s, end_s});
    }
  }
  return spans;
}

}  // namespace

OpenlorisSequenceScore score_openloris_sequence(const Trajectory& gt, const Trajectory& est,
                                                const Similarity& S_w_v, const OpenlorisOptions& options) {
  STILLPOINT_CHECK(!gt.poses.empty());
  OpenlorisSequenceScore score;
  score.poses = est.poses.size();
  const Timestamp start = gt.poses.front().t;
  score.gt_duration_s = seconds_between(start, gt.poses.back().t);
  const std::vector<MatchedPose> matches =
      matched_poses(gt, est, associate_interpolated(gt, est, options.max_gap_s));
  score.matches = matches.size();
  if (matches.empty()) return score;

  const AteErrors errors = ate_errors(matches, S_w_v);
  const std::vector<bool> correct = correct_mask(errors, options.correct);
  score.correct = static_cast<std::size_t>(std::count(correct.begin(), correct.end(), true));
  score.ate_rmse_m = rmse(errors.translation_m);
  score.aoe_rmse_deg = rmse(errors.rotation_deg);
  score.correct_ate_rmse_m = rmse(select(errors.translation_m, correct));
  score.correct_aoe_rmse_deg = rmse(select(errors.rotation_deg, correct));

  const Timestamp end = std::max(gt.poses.back().t, matches.back().t);
  score.tracked_spans = spans_of(matches, correct, gt, options.correct.max_hold_s);
  score.correct_time_s = correct_seconds(matches, errors, end, options.correct);
  score.tracked_time_s = seconds_between(matches.front().t, end);
  score.correct_rate = score.correct_time_s / seconds_between(start, end);
  if (score.tracked_time_s > 0.0) score.tracked_rate = score.correct_time_s / score.tracked_time_s;
  score.relocalization_time_s = std::max(0.0, seconds_between(start, matches.front().t));
  if (correct.front()) {
    score.relocalization_score = std::exp(-*score.relocalization_time_s / kRelocalizationScale);
  }
  return score;
}

Similarity align_openloris(const std::map<int, Trajectory>& gt, const std::map<int, Trajectory>& est,
                           const OpenlorisOptions& options) {
  for (const auto& [number, trajectory] : est) {
    const auto truth = gt.find(number);
    if (truth == gt.end()) continue;
    const std::vector<MatchedPose> matches = matched_poses(
        truth->second, trajectory, associate_interpolated(truth->second, trajectory, options.max_gap_s));
    if (!matches.empty()) return align(matches, options.scale ? Alignment::kSim3 : Alignment::kSe3).S_w_v;
  }
  return {};
}

}  // namespace stillpoint::eval
