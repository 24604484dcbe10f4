// SPDX-License-Identifier: BSD-3-Clause
#include "bench/compare/history_changes.h"

#include <algorithm>
#include <cmath>

#include "eval/metrics/statistics.h"
#include "eval/statistics/level.h"

namespace stillpoint {
namespace {

constexpr double kTrendSignificance = 0.005;

/// The newest values of a series, and where its changes are.
struct Judged {
  const HistorySeries& series;
  std::size_t offset = 0;  ///< of the first judged value
  std::span<const double> values;
  std::vector<std::size_t> changes;  ///< indices into `values`

  [[nodiscard]] std::size_t commit(std::size_t i) const { return series.commits[offset + i]; }
  /// Values between the changes around change number `i`; 0 lies before the first.
  [[nodiscard]] std::span<const double> segment(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : changes[i - 1];
    const std::size_t end = i == changes.size() ? values.size() : changes[i];
    return values.subspan(begin, end - begin);
  }
};

double median_of(std::span<const double> values) { return *percentile(values, 0.5); }

/// 1 where larger is worse, -1 where it is better.
double bad_direction(const MetricRule& rule) { return rule.larger_is_better ? -1.0 : 1.0; }

/// Whether two levels differ by what matters, whatever the direction.
bool matters(double before, double after, const std::optional<MetricRule>& rule) {
  if (!rule) return before != after;
  const double difference = std::abs(after - before);
  return difference >= rule->floor && difference >= rule->margin * std::abs(before);
}

/// Whether it is so certain and large that it can be told as a change.
bool is_change(const LevelShift& shift, const std::optional<MetricRule>& rule) {
  if (!matters(shift.level_before, shift.level_after, rule)) return false;
  return !shift.change || shift.change->interval.low > 0.0 || shift.change->interval.high < 0.0;
}

bool is_worse(double before, double after, const MetricRule& rule) {
  return bad_direction(rule) * (after - before) > 0.0 && matters(before, after, rule);
}

/// @param newest level of the series
ChangeState state_of(const LevelShift& shift, const std::optional<MetricRule>& rule, double newest) {
  if (!rule) return ChangeState::kNeutral;
  if (!is_worse(shift.level_before, shift.level_after, *rule)) return ChangeState::kImproved;
  return is_worse(shift.level_before, newest, *rule) ? ChangeState::kOpen : ChangeState::kEnded;
}

std::vector<LevelShift> shifts_of(const Judged& judged, std::size_t index,
                                  const std::vector<ChangePoint>& points) {
  std::vector<LevelShift> shifts;
  const double newest = median_of(judged.segment(judged.changes.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::span<const double> before = judged.segment(i);
    const std::span<const double> after = judged.segment(i + 1);
    LevelShift shift{.series = index,
                     .before = judged.commit(points[i].index - 1),
                     .after = judged.commit(points[i].index),
                     .level_before = median_of(before),
                     .level_after = median_of(after),
                     .change = level_change(before, after),
                     .p_value = points[i].p_value,
                     .state = ChangeState::kNeutral,
                     .reason = ""};
    if (!is_change(shift, judged.series.rule)) continue;
    shift.state = state_of(shift, judged.series.rule, newest);
    shifts.push_back(shift);
  }
  return shifts;
}

std::optional<Creep> creep_of(const Judged& judged, std::size_t index) {
  if (!judged.series.rule) return std::nullopt;
  const std::optional<Trend> trend = trend_of(judged.values);
  if (!trend || trend->p_value > kTrendSignificance) return std::nullopt;
  const double end = trend->start + trend->slope * static_cast<double>(judged.values.size() - 1);
  if (trend->start == 0.0 || !matters(trend->start, end, judged.series.rule)) return std::nullopt;
  if (!line_fits_better(judged.values, *trend, judged.changes)) return std::nullopt;
  return Creep{.series = index,
               .first = judged.commit(0),
               .last = judged.commit(judged.values.size() - 1),
               .start = trend->start,
               .end = end,
               .change = (end - trend->start) / std::abs(trend->start),
               .p_value = trend->p_value,
               .worse = bad_direction(*judged.series.rule) * trend->slope > 0.0};
}

/// From the newest commit that failed less than the last one does.
std::optional<LevelShift> new_failures(const HistorySeries& series, std::size_t index) {
  const double newest = series.values.back();
  for (std::size_t i = series.values.size() - 1; i-- > 0;) {
    if (series.values[i] >= newest) continue;
    return LevelShift{.series = index,
                      .before = series.commits[i],
                      .after = series.commits[i + 1],
                      .level_before = series.values[i],
                      .level_after = newest,
                      .change = std::nullopt,
                      .p_value = 0.0,
                      .state = ChangeState::kOpen,
                      .reason = ""};
  }
  return std::nullopt;
}

/// How many measured commits of a series lie before one.
std::ptrdiff_t place_in(const HistorySeries& series, std::size_t commit) {
  return std::lower_bound(series.commits.begin(), series.commits.end(), commit) - series.commits.begin();
}

/// A change is found within a minimum segment of where it is, and moves as more commits are measured.
bool covers(const Acceptance& acceptance, const CommitHistory& history, const LevelShift& shift,
            std::size_t min_segment) {
  const HistorySeries& series = history.series[shift.series];
  if (acceptance.metric != series.metric) return false;
  if (!acceptance.variant.empty() && acceptance.variant != series.subject.variant) return false;
  if (!acceptance.sequence.empty() && acceptance.sequence != series.subject.sequence) return false;
  const auto found = std::find_if(history.commits.begin(), history.commits.end(),
                                  [&](const Commit& commit) { return commit.name == acceptance.commit; });
  if (found == history.commits.end()) return false;
  const auto commit = static_cast<std::size_t>(found - history.commits.begin());
  const std::ptrdiff_t distance = place_in(series, commit) - place_in(series, shift.after);
  return std::abs(distance) < static_cast<std::ptrdiff_t>(min_segment);
}

void accept(std::vector<LevelShift>& shifts, const CommitHistory& history,
            std::span<const Acceptance> acceptances, std::size_t min_segment) {
  for (LevelShift& shift : shifts) {
    if (shift.state != ChangeState::kOpen) continue;
    const auto found = std::find_if(
        acceptances.begin(), acceptances.end(),
        [&](const Acceptance& acceptance) { return covers(acceptance, history, shift, min_segment); });
    if (found == acceptances.end()) continue;
    shift.state = ChangeState::kAccepted;
    shift.reason = found->reason;
  }
}

/// A series that stays within its margin has no change that matters.
bool may_have_changed(std::span<const double> values, const std::optional<MetricRule>& rule) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return low != high && (matters(*low, *high, rule) || matters(*high, *low, rule));
}

}  // namespace

std::string state_name(ChangeState state) {
  switch (state) {
    case ChangeState::kOpen:
      return "open";
    case ChangeState::kAccepted:
      return "accepted";
    case ChangeState::kEnded:
      return "ended";
    case ChangeState::kImproved:
      return "improved";
    case ChangeState::kNeutral:
      return "neutral";
  }
  return "";
}

HistoryChanges history_changes(const CommitHistory& history, std::span<const Acceptance> acceptances,
                               const ChangePointOptions& options) {
  HistoryChanges changes;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const HistorySeries& series = history.series[i];
    if (series.metric == kFailedRuns) {
      if (const std::optional<LevelShift> failures = new_failures(series, i))
        changes.shifts.push_back(*failures);
      continue;
    }
    const std::size_t offset = series.values.size() - std::min(series.values.size(), kJudgedCommits);
    Judged judged{.series = series, .offset = offset, .values = std::span(series.values).subspan(offset)};
    if (!may_have_changed(judged.values, series.rule)) continue;
    const std::vector<ChangePoint> points = change_points(judged.values, options);
    for (const ChangePoint& point : points) judged.changes.push_back(point.index);
    for (LevelShift& shift : shifts_of(judged, i, points)) changes.shifts.push_back(std::move(shift));
    if (const std::optional<Creep> creep = creep_of(judged, i)) changes.creeps.push_back(*creep);
  }
  accept(changes.shifts, history, acceptances, options.min_segment);
  return changes;
}

}  // namespace stillpoint
