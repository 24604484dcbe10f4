// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/common_support.h"

#include <algorithm>
#include <limits>

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/orientations.h"

namespace stillpoint::eval {
namespace {

/// Parts of `whole` that do not overlap any of `lost`.
std::vector<TimeSpan> complement_of(std::vector<TimeSpan> lost, const TimeSpan& whole) {
  std::sort(lost.begin(), lost.end(), [](const TimeSpan& a, const TimeSpan& b) { return a.begin < b.begin; });
  std::vector<TimeSpan> remaining;
  Timestamp from = whole.begin;
  for (const TimeSpan& span : lost) {
    if (span.begin > from) remaining.push_back({from, span.begin});
    from = std::max(from, span.end);
  }
  if (from < whole.end) remaining.push_back({from, whole.end});
  return remaining;
}

std::vector<MatchedPose> matches_within(MatchView matches, std::span<const TimeSpan> spans) {
  std::vector<MatchedPose> selected;
  auto span = spans.begin();
  for (const MatchedPose& match : matches) {
    while (span != spans.end() && span->end < match.t) ++span;
    if (span == spans.end()) break;
    if (match.t >= span->begin) selected.push_back(match);
  }
  return selected;
}

std::optional<double> ate_rmse(MatchView matches, Alignment alignment) {
  const std::optional<Statistics> errors =
      statistics(ate_errors(matches, align(matches, alignment).S_w_v).translation_m);
  if (!errors || errors->count < 3) return std::nullopt;
  return errors->rmse;
}

bool ranks_before(const ComparedRun& a, const ComparedRun& b) {
  if (a.failed != b.failed) return b.failed;
  if (a.failed) return a.coverage > b.coverage;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return a.common_ate_rmse_m.value_or(kNone) < b.common_ate_rmse_m.value_or(kNone);
}

/// `run` with its errors over the common spans.
ComparedRun with_common_errors(ComparedRun run, MatchView matches, std::span<const TimeSpan> common,
                               const CompareOptions& options) {
  const std::vector<MatchedPose> shared = matches_within(matches, common);
  run.common_pairs = shared.size();
  run.common_ate_rmse_m = ate_rmse(shared, options.alignment);
  if (const StrictRpeResult rpe = strict_rpe(shared, options.rpe_delta_s); rpe.errors) {
    run.common_rpe_m = rpe.errors->translation_m.rmse / options.rpe_delta_s;
    run.common_rpe_deg = rpe.errors->rotation_deg.rmse / options.rpe_delta_s;
    run.common_rpe_pairs = rpe.errors->translation_m.count;
  }
  return run;
}

}  // namespace

Comparison compare_runs(const Trajectory& gt, std::span<const NamedRun> runs, const CompareOptions& options) {
  Comparison comparison;
  if (gt.poses.size() < 2) return comparison;
  const TimeSpan whole{gt.poses.front().t, gt.poses.back().t};
  std::vector<TimeSpan> lost_by_any;
  std::vector<PoseMatches> matches;
  matches.reserve(runs.size());
  for (const NamedRun& run : runs) {
    const std::vector<TimeSpan> lost = lost_spans(run.est, whole, options.max_hold_s);
    matches.emplace_back(gt, run.est, associate_interpolated(gt, run.est, options.max_gap_s));
    ComparedRun compared;
    compared.name = run.name;
    compared.coverage = time_coverage(lost, whole).value_or(0.0);
    compared.failed = matches.back().size() < 2 || compared.coverage < options.min_coverage;
    compared.own_ate_rmse_m = ate_rmse(matches.back(), options.alignment);
    if (!compared.failed) lost_by_any.insert(lost_by_any.end(), lost.begin(), lost.end());
    comparison.ranking.push_back(compared);
  }
  const std::vector<TimeSpan> common = complement_of(lost_by_any, whole);
  for (const TimeSpan& span : common) comparison.common_s += seconds_between(span.begin, span.end);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    ComparedRun& run = comparison.ranking[i];
    if (run.failed) continue;
    run = with_common_errors(run, matches[i], common, options);
    if (missing_orientations(gt, runs[i].est).empty()) continue;
    run.common_rpe_m = run.common_rpe_deg = std::nullopt;
    run.common_rpe_pairs = 0;
  }
  std::stable_sort(comparison.ranking.begin(), comparison.ranking.end(), ranks_before);
  return comparison;
}

}  // namespace stillpoint::eval
