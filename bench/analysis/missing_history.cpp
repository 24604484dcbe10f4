// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/missing_history.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "bench/analysis/missing_results.h"

namespace stillpoint::bench {
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

/// The newest commit of the machine, mode and kind of a subject, if it has more than half of the subjects
/// that were measured with this one, but not this one.
std::optional<std::size_t> not_measured_at(const SubjectHistories& subjects, const HistorySubject& name,
                                           std::size_t last) {
  const auto scope = [](const HistorySubject& subject) {
    return std::tie(subject.host, subject.mode, subject.kind, subject.cores);
  };
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

}  // namespace

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

}  // namespace stillpoint::bench
