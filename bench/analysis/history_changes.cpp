// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/history_changes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "bench/analysis/missing_results.h"
#include "eval/metrics/statistics.h"
#include "eval/statistics/change_points.h"

namespace stillpoint::bench {
namespace {

constexpr double kTrendSignificance = 0.005;

/// The analyzed part of a series, and its change points.
struct AnalyzedSeries {
  const HistorySeries& series;
  std::size_t offset = 0;  ///< index of the first analyzed value
  std::span<const double> values;
  std::vector<std::size_t> changes;  ///< indices into `values`

  [[nodiscard]] std::size_t commit(std::size_t i) const { return series.commits[offset + i]; }
  /// Segment `i` between consecutive change points; segment 0 lies before the first.
  [[nodiscard]] std::span<const double> segment(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : changes[i - 1];
    const std::size_t end = i == changes.size() ? values.size() : changes[i];
    return values.subspan(begin, end - begin);
  }
};

double median_of(std::span<const double> values) { return *eval::percentile(values, 0.5); }

/// 1 if larger is worse, -1 if larger is better.
double bad_direction(const MetricDescriptor& metric) {
  return metric.direction == MetricDirection::kLargerIsBetter ? -1.0 : 1.0;
}

/// Whether two levels differ by at least the margin and the floor, in any direction.
bool is_relevant(double before, double after, const MetricDescriptor* gated) {
  if (gated == nullptr) return before != after;
  const double difference = std::abs(after - before);
  return difference >= gated->gate->floor && difference >= gated->gate->margin * std::abs(before);
}

/// Whether the shift is relevant and its confidence interval excludes 0.
bool is_significant(const LevelShift& shift, const MetricDescriptor* gated) {
  if (!is_relevant(shift.level_before, shift.level_after, gated)) return false;
  return !shift.change || eval::is_significant(*shift.change);
}

bool is_worse(double before, double after, const MetricDescriptor& gated) {
  return bad_direction(gated) * (after - before) > 0.0 && is_relevant(before, after, &gated);
}

/// @param newest newest level of the series
ChangeState state_of(const LevelShift& shift, const MetricDescriptor* gated, double newest) {
  if (gated == nullptr) return ChangeState::kNeutral;
  if (!is_worse(shift.level_before, shift.level_after, *gated)) return ChangeState::kImproved;
  return is_worse(shift.level_before, newest, *gated) ? ChangeState::kOpen : ChangeState::kResolved;
}

/// Whether the levels around change point `i` differ by a relevant step, not only by a trend that they share.
bool is_step(const AnalyzedSeries& analyzed, std::size_t i) {
  const MetricDescriptor* gated = analyzed.series.gated;
  if (gated == nullptr) return true;
  const std::span<const double> before = analyzed.segment(i);
  const std::span<const double> after = analyzed.segment(i + 1);
  const double level = median_of(before);
  const double step = eval::step_beside_trend(before, after);
  return step * (median_of(after) - level) > 0.0 && is_relevant(level, level + step, gated);
}

std::vector<LevelShift> shifts_of(const AnalyzedSeries& analyzed, std::size_t index,
                                  const std::vector<eval::ChangePoint>& points) {
  std::vector<LevelShift> shifts;
  const double newest = median_of(analyzed.segment(analyzed.changes.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::span<const double> before = analyzed.segment(i);
    const std::span<const double> after = analyzed.segment(i + 1);
    LevelShift shift{.series = index,
                     .before = analyzed.commit(points[i].index - 1),
                     .after = analyzed.commit(points[i].index),
                     .level_before = median_of(before),
                     .level_after = median_of(after),
                     .change = eval::level_change(before, after),
                     .p_value = points[i].p_value,
                     .state = ChangeState::kNeutral,
                     .reason = ""};
    if (!is_significant(shift, analyzed.series.gated) || !is_step(analyzed, i)) continue;
    shift.state = state_of(shift, analyzed.series.gated, newest);
    shifts.push_back(shift);
  }
  return shifts;
}

std::optional<MetricDrift> drift_of(const AnalyzedSeries& analyzed, std::size_t index) {
  if (analyzed.series.gated == nullptr) return std::nullopt;
  const std::optional<eval::Trend> trend = eval::trend_of(analyzed.values);
  if (!trend || trend->p_value > kTrendSignificance) return std::nullopt;
  const double end = trend->intercept + trend->slope * static_cast<double>(analyzed.values.size() - 1);
  if (trend->intercept == 0.0 || !is_relevant(trend->intercept, end, analyzed.series.gated))
    return std::nullopt;
  // Many small steps are a drift as well: only relevant steps compete with the line.
  std::vector<std::size_t> steps;
  for (std::size_t i = 0; i < analyzed.changes.size(); ++i) {
    if (is_step(analyzed, i)) steps.push_back(analyzed.changes[i]);
  }
  if (!eval::linear_trend_fits_better(analyzed.values, *trend, steps)) return std::nullopt;
  return MetricDrift{.series = index,
                     .first = analyzed.commit(0),
                     .last = analyzed.commit(analyzed.values.size() - 1),
                     .start = trend->intercept,
                     .end = end,
                     .change = (end - trend->intercept) / std::abs(trend->intercept),
                     .p_value = trend->p_value,
                     .worse = bad_direction(*analyzed.series.gated) * trend->slope > 0.0};
}

/// Shift from the most recent commit with a smaller failure rate than the newest commit.
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

/// Median of the absolute relative changes between consecutive values; 0 for a deterministic metric.
double typical_change(std::span<const double> values) {
  std::vector<double> changes;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double scale = std::max(std::abs(values[i - 1]), std::abs(values[i]));
    changes.push_back(scale > 0.0 ? std::abs(values[i] - values[i - 1]) / scale : 0.0);
  }
  return changes.empty() ? 1.0 : *eval::percentile(changes, 0.5);
}

/// Change points of a metric without noise: each relevant step, at a distance from others and from the ends.
std::vector<eval::ChangePoint> exact_steps(std::span<const double> values, const MetricDescriptor& gated,
                                           std::size_t min_segment) {
  std::vector<eval::ChangePoint> steps;
  std::size_t begin = 0;  // of the current level
  for (std::size_t i = 2; i + min_segment <= values.size(); ++i) {
    if (i < begin + 2 || !is_relevant(values[i - 1], values[i], &gated)) continue;
    const double level = median_of(values.subspan(begin, i - begin));
    const bool is_kept = std::ranges::all_of(values.subspan(i, min_segment), [&](double value) {
      return (value > level) == (values[i] > level) && is_relevant(level, value, &gated);
    });
    if (!is_kept) continue;
    steps.push_back({.index = i, .p_value = 0.0});
    begin = i;
  }
  return steps;
}

/// Whether a metric has no noise, so that each relevant step counts.
bool is_exact(const AnalyzedSeries& analyzed) {
  constexpr double kMaxNoise = 0.1;  // of the margin
  const MetricDescriptor* gated = analyzed.series.gated;
  return gated != nullptr && gated->gate->repeatable &&
         typical_change(analyzed.values) <= kMaxNoise * gated->gate->margin;
}

/// Shifts at exact steps; their levels need no test.
std::vector<LevelShift> exact_shifts(const AnalyzedSeries& analyzed, std::size_t index) {
  const double newest = median_of(analyzed.segment(analyzed.changes.size()));
  std::vector<LevelShift> shifts;
  for (std::size_t i = 0; i < analyzed.changes.size(); ++i) {
    LevelShift shift{.series = index,
                     .before = analyzed.commit(analyzed.changes[i] - 1),
                     .after = analyzed.commit(analyzed.changes[i]),
                     .level_before = median_of(analyzed.segment(i)),
                     .level_after = median_of(analyzed.segment(i + 1)),
                     .change = eval::level_change(analyzed.segment(i), analyzed.segment(i + 1))};
    shift.state = state_of(shift, analyzed.series.gated, newest);
    shifts.push_back(std::move(shift));
  }
  return shifts;
}

/// Number of measured commits of a series before a commit.
std::ptrdiff_t position_in(const HistorySeries& series, std::size_t commit) {
  return std::lower_bound(series.commits.begin(), series.commits.end(), commit) - series.commits.begin();
}

/// The commit of an acceptance that applies to a series; nullopt if it does not.
std::optional<std::size_t> accepted_commit(const Acceptance& acceptance, const CommitHistory& history,
                                           const HistorySeries& series) {
  if (acceptance.metric != series.metric) return std::nullopt;
  if (!acceptance.variant.empty() && acceptance.variant != series.subject.variant) return std::nullopt;
  if (!acceptance.sequence.empty() && acceptance.sequence != series.subject.sequence) return std::nullopt;
  const auto found = std::ranges::find(history.commits, acceptance.commit, &Commit::name);
  if (found == history.commits.end()) return std::nullopt;
  return static_cast<std::size_t>(found - history.commits.begin());
}

/// Whether an acceptance applies to a shift. The detected position of a shift may vary by less than a minimum
/// segment as commits are added; that of a missing result does not.
bool covers(const Acceptance& acceptance, const CommitHistory& history, const LevelShift& shift,
            std::size_t min_segment) {
  const HistorySeries& series = history.series[shift.series];
  const std::optional<std::size_t> commit = accepted_commit(acceptance, history, series);
  if (!commit) return false;
  if (!shift.missing.empty()) return *commit == shift.after;
  const std::ptrdiff_t distance = position_in(series, *commit) - position_in(series, shift.after);
  return std::abs(distance) < static_cast<std::ptrdiff_t>(min_segment);
}

/// Marks the open shifts that an acceptance covers.
std::vector<LevelShift> with_acceptances(std::vector<LevelShift> shifts, const CommitHistory& history,
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
  return shifts;
}

/// Marks the drifts of which an acceptance covers all but an irrelevant rest since its commit.
std::vector<MetricDrift> with_acceptances(std::vector<MetricDrift> drifts, const CommitHistory& history,
                                          std::span<const Acceptance> acceptances) {
  for (MetricDrift& drift : drifts) {
    const HistorySeries& series = history.series[drift.series];
    const auto length =
        static_cast<double>(position_in(series, drift.last) - position_in(series, drift.first));
    for (const Acceptance& acceptance : acceptances) {
      const std::optional<std::size_t> commit = accepted_commit(acceptance, history, series);
      if (!commit || *commit < drift.first) continue;
      const auto covered =
          static_cast<double>(position_in(series, *commit) - position_in(series, drift.first));
      const double value = drift.start + (drift.end - drift.start) * std::min(1.0, covered / length);
      drift.is_accepted = drift.is_accepted || !is_relevant(value, drift.end, series.gated);
    }
  }
  return drifts;
}

/// Quick rejection: a series whose range is below the margin has no relevant change.
bool may_have_changed(std::span<const double> values, const MetricDescriptor* gated) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return low != high && (is_relevant(*low, *high, gated) || is_relevant(*high, *low, gated));
}

}  // namespace

std::string state_name(ChangeState state) {
  switch (state) {
    case ChangeState::kOpen:
      return "open";
    case ChangeState::kAccepted:
      return "accepted";
    case ChangeState::kResolved:
      return "resolved";
    case ChangeState::kImproved:
      return "improved";
    case ChangeState::kNeutral:
      return "neutral";
  }
  return "";
}

namespace {

/// When a subject was measured, and its series.
struct SubjectHistory {
  std::vector<std::size_t> measured;   ///< commits with a run
  std::vector<std::size_t> succeeded;  ///< commits with a successful run
  std::vector<std::size_t> series;
  std::size_t headline = 0;  ///< series of the headline metric, or of the failed runs
};
using SubjectHistories = std::map<HistorySubject, SubjectHistory>;

SubjectHistories subjects_in(const CommitHistory& history) {
  SubjectHistories subjects;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const HistorySeries& series = history.series[i];
    SubjectHistory& subject = subjects[series.subject];
    subject.series.push_back(i);
    if (series.metric == headline_metric().id) subject.headline = i;
    if (series.metric != metric_id::kFailedRuns) continue;
    subject.measured = series.commits;
    for (std::size_t k = 0; k < series.commits.size(); ++k) {
      if (series.values[k] < 1.0) subject.succeeded.push_back(series.commits[k]);
    }
  }
  for (auto& [name, subject] : subjects) {
    const bool has_headline = std::ranges::find(subject.series, subject.headline) != subject.series.end();
    if (!has_headline && !subject.series.empty()) subject.headline = subject.series.front();
  }
  std::erase_if(subjects, [](const auto& entry) { return entry.second.measured.empty(); });
  return subjects;
}

LevelShift missing_shift(const HistorySeries& series, std::size_t index, std::size_t after,
                         const std::string& reason) {
  return {.series = index,
          .before = series.commits.back(),
          .after = after,
          .level_before = series.values.back(),
          .level_after = std::numeric_limits<double>::quiet_NaN(),
          .change = std::nullopt,
          .p_value = 0.0,
          .state = ChangeState::kOpen,
          .reason = "",
          .missing = reason};
}

/// Metrics that the newest successful runs of a subject lack.
void add_missing_metrics(std::vector<LevelShift>& shifts, const CommitHistory& history,
                         const SubjectHistory& subject) {
  for (const std::size_t i : subject.series) {
    const HistorySeries& series = history.series[i];
    if (series.metric == metric_id::kFailedRuns || !must_exist(series.metric)) continue;
    const auto next = std::ranges::upper_bound(subject.succeeded, series.commits.back());
    if (next != subject.succeeded.end()) shifts.push_back(missing_shift(series, i, *next, "no value"));
  }
}

/// The first commit after `last` at which the subject was measured on other data; nullopt without.
std::optional<std::size_t> other_data_since(const SubjectHistories& subjects, const HistorySubject& name,
                                            std::size_t last) {
  std::optional<std::size_t> first;
  for (const auto& [other, history] : subjects) {
    HistorySubject same = other;
    same.sequence_id = name.sequence_id;
    if (same != name || other.sequence_id == name.sequence_id) continue;
    const auto next = std::ranges::upper_bound(history.measured, last);
    if (next != history.measured.end() && (!first || *next < *first)) first = *next;
  }
  return first;
}

/// Whether a subject was measured after `last` on another machine, as when the first one was replaced.
bool is_measured_elsewhere(const SubjectHistories& subjects, const HistorySubject& name, std::size_t last) {
  return std::ranges::any_of(subjects, [&](const auto& entry) {
    HistorySubject same = entry.first;
    same.host = name.host;
    return same == name && entry.second.measured.back() > last;
  });
}

/// The newest commit of the machine, mode and kind of a subject, if it has more than half of the subjects
/// that were measured with this one, but not this one.
std::optional<std::size_t> not_measured_at(const SubjectHistories& subjects, const HistorySubject& name,
                                           std::size_t last) {
  const auto scope = [](const HistorySubject& subject) {
    return std::tie(subject.host, subject.mode, subject.kind, subject.cores);
  };
  if (is_measured_elsewhere(subjects, name, last)) return std::nullopt;
  std::size_t newest = last;
  std::vector<const SubjectHistory*> companions;
  for (const auto& [other, history] : subjects) {
    if (scope(other) != scope(name)) continue;
    newest = std::max(newest, history.measured.back());
    if (other != name && std::ranges::binary_search(history.measured, last)) companions.push_back(&history);
  }
  const auto present = std::ranges::count_if(
      companions, [&](const SubjectHistory* companion) { return companion->measured.back() == newest; });
  if (newest == last || companions.empty() || 2 * static_cast<std::size_t>(present) <= companions.size())
    return std::nullopt;
  return newest;
}

/// Open shifts without a new level: `level_after` is not a number, `missing` says why.
std::vector<LevelShift> missing_shifts(const CommitHistory& history) {
  const SubjectHistories subjects = subjects_in(history);
  std::vector<LevelShift> shifts;
  for (const auto& [name, subject] : subjects) {
    add_missing_metrics(shifts, history, subject);
    const std::size_t last = subject.measured.back();
    const HistorySeries& headline = history.series[subject.headline];
    if (const std::optional<std::size_t> other = other_data_since(subjects, name, last)) {
      shifts.push_back(missing_shift(headline, subject.headline, *other, "other data"));
    } else if (const std::optional<std::size_t> newest = not_measured_at(subjects, name, last)) {
      shifts.push_back(missing_shift(headline, subject.headline, *newest, "not measured"));
    }
  }
  return shifts;
}

}  // namespace

HistoryChanges history_changes(const CommitHistory& history, std::span<const Acceptance> acceptances,
                               const eval::ChangePointOptions& options) {
  HistoryChanges changes{.shifts = missing_shifts(history), .drifts = {}};
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const HistorySeries& series = history.series[i];
    if (series.metric == metric_id::kFailedRuns) {
      if (const std::optional<LevelShift> failures = new_failures(series, i))
        changes.shifts.push_back(*failures);
      continue;
    }
    const std::size_t offset = series.values.size() - std::min(series.values.size(), kMaxAnalyzedCommits);
    AnalyzedSeries analyzed{
        .series = series, .offset = offset, .values = std::span(series.values).subspan(offset)};
    if (!may_have_changed(analyzed.values, series.gated)) continue;
    const bool is_without_noise = is_exact(analyzed);
    const std::vector<eval::ChangePoint> points =
        is_without_noise ? exact_steps(analyzed.values, *series.gated, options.min_segment)
                         : eval::change_points(analyzed.values, options);
    for (const eval::ChangePoint& point : points) analyzed.changes.push_back(point.index);
    for (LevelShift& shift : is_without_noise ? exact_shifts(analyzed, i) : shifts_of(analyzed, i, points))
      changes.shifts.push_back(std::move(shift));
    if (const std::optional<MetricDrift> drift = drift_of(analyzed, i)) changes.drifts.push_back(*drift);
  }
  changes.shifts = with_acceptances(std::move(changes.shifts), history, acceptances, options.min_segment);
  changes.drifts = with_acceptances(std::move(changes.drifts), history, acceptances);
  return changes;
}

namespace {

constexpr std::size_t kMaxNewest = 5;    // a longer new level is a matter of the change detection
constexpr std::size_t kMaxEarlier = 40;  // bounds the cost of the exact test

/// Whether all newest values are relevant steps in one direction and their median is outside of the range.
bool is_new_level(std::span<const double> earlier, std::span<const double> newest,
                  const MetricDescriptor& gated) {
  const double level = median_of(earlier);
  const bool is_larger = newest.front() > level;
  const auto [low, high] = std::minmax_element(earlier.begin(), earlier.end());
  const double after = median_of(newest);
  return (after > *high || after < *low) && std::ranges::all_of(newest, [&](double value) {
           return (value > level) == is_larger && size_in_margins(level, value, gated) >= 1.0;
         });
}

/// The values of a level without its newest `count`.
std::span<const double> earlier_values(std::span<const double> level, std::size_t count) {
  const std::span<const double> earlier = level.first(level.size() - count);
  return earlier.last(std::min(earlier.size(), kMaxEarlier));
}

std::optional<SuspectedChange> suspicion_of(const HistorySeries& series, std::size_t index,
                                            std::size_t level_start) {
  const std::span<const double> values = std::span(series.values).subspan(level_start);
  std::optional<SuspectedChange> found;
  for (std::size_t count = 1; count <= kMaxNewest && count < values.size(); ++count) {
    const std::span<const double> newest = values.last(count);
    const std::span<const double> earlier = earlier_values(values, count);
    if (!is_new_level(earlier, newest, *series.gated)) continue;
    const std::size_t at = series.values.size() - count;
    const double before = median_of(earlier);
    const double after = median_of(newest);
    const double p = eval::rank_sum(earlier, newest)->p_value * static_cast<double>(kMaxNewest);
    found = {.series = index,
             .before = series.commits[at - 1],
             .after = series.commits[at],
             .level_before = before,
             .level_after = after,
             .count_before = earlier.size(),
             .count_after = count,
             .p_value = std::min(p, 1.0),
             .is_exact = series.gated->gate->repeatable && earlier.size() > 1 &&
                         std::ranges::all_of(earlier, [&](double value) { return value == before; }),
             .worse = bad_direction(*series.gated) * (after - before) > 0.0};
  }
  return found;
}

/// Index of the first value of the newest confirmed level of each series.
std::vector<std::size_t> level_starts(const CommitHistory& history, const HistoryChanges& changes) {
  std::vector<std::size_t> starts(history.series.size(), 0);
  for (const LevelShift& shift : changes.shifts) {
    const std::vector<std::size_t>& commits = history.series[shift.series].commits;
    const auto first = std::lower_bound(commits.begin(), commits.end(), shift.after);
    starts[shift.series] = std::max(starts[shift.series], static_cast<std::size_t>(first - commits.begin()));
  }
  return starts;
}

int rank_of(const MetricDescriptor* metric) {
  if (metric == nullptr || !metric->gate) return 2;
  return metric->gate->family == MetricFamily::kAccuracy ? 0 : 1;
}

bool is_compared(const HistorySeries& series) {
  return series.gated != nullptr && series.metric != metric_id::kFailedRuns;
}

}  // namespace

double size_in_margins(double before, double after, const MetricDescriptor& gated) {
  const double relevant = std::max(gated.gate->floor, gated.gate->margin * std::abs(before));
  if (after == before) return 0.0;
  return relevant > 0.0 ? std::abs(after - before) / relevant : std::numeric_limits<double>::infinity();
}

bool precedes(const MetricDescriptor* a, double size_a, const MetricDescriptor* b, double size_b) {
  if (std::isinf(size_a) != std::isinf(size_b)) return std::isinf(size_a);
  return rank_of(a) != rank_of(b) ? rank_of(a) < rank_of(b) : size_a > size_b;
}

std::vector<SuspectedChange> suspected_changes(const CommitHistory& history, const HistoryChanges& changes) {
  const std::vector<std::size_t> starts = level_starts(history, changes);
  std::vector<SuspectedChange> suspected;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const HistorySeries& series = history.series[i];
    if (!is_compared(series) || starts[i] >= series.values.size()) continue;
    if (const std::optional<SuspectedChange> found = suspicion_of(series, i, starts[i]))
      suspected.push_back(*found);
  }
  const auto size = [&](const SuspectedChange& change) {
    return size_in_margins(change.level_before, change.level_after, *history.series[change.series].gated);
  };
  std::ranges::stable_sort(suspected, [&](const SuspectedChange& a, const SuspectedChange& b) {
    return precedes(history.series[a.series].gated, size(a), history.series[b.series].gated, size(b));
  });
  return suspected;
}

std::optional<double> visible_step(const CommitHistory& history, const HistoryChanges& changes,
                                   MetricFamily family) {
  const std::vector<std::size_t> starts = level_starts(history, changes);
  std::vector<double> steps;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const HistorySeries& series = history.series[i];
    if (!is_compared(series) || series.gated->gate->family != family) continue;
    if (starts[i] + 2 > series.values.size()) continue;
    const std::span<const double> earlier = earlier_values(std::span(series.values).subspan(starts[i]), 1);
    const double level = median_of(earlier);
    if (level == 0.0) continue;
    const auto [low, high] = std::minmax_element(earlier.begin(), earlier.end());
    steps.push_back(
        std::max(series.gated->gate->margin, std::max(*high - level, level - *low) / std::abs(level)));
  }
  return eval::percentile(steps, 0.5);
}

}  // namespace stillpoint::bench
