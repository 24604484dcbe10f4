// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/regression_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/dashboard/history_text.h"
#include "reports/tables/escaping.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

/// Sort key: newly failing runs rank above any change of a metric.
double magnitude(const bench::LevelShift& shift) {
  return shift.change ? std::abs(shift.change->median) : std::numeric_limits<double>::infinity();
}

Json subject_json(const bench::CommitHistory& history, const bench::HistorySeries& series) {
  const bench::HistorySubject& subject = series.subject;
  Json json = {{"metric", clean_line(series.metric)},      {"variant", clean_line(subject.variant)},
               {"sequence", clean_line(subject.sequence)}, {"seed", subject.seed},
               {"mode", clean_line(subject.mode)},         {"kind", clean_line(subject.kind)},
               {"host", clean_line(subject.host)}};
  if (!subject.axis.empty())
    json["sweep"] = {{"axis", clean_line(subject.axis)}, {"value", subject.axis_value}};
  json["newest_commit"] = clean_line(history.commits[series.commits.back()].name);
  return json;
}

Json shift_json(const bench::CommitHistory& history, const bench::LevelShift& shift) {
  const bench::HistorySeries& series = history.series[shift.series];
  Json json = subject_json(history, series);
  json["last_commit_before"] = clean_line(history.commits[shift.before].name);
  json["first_commit_after"] = clean_line(history.commits[shift.after].name);
  json["unit"] = clean_line(series.unit);
  json["before"] = shift.level_before;
  json["after"] = shift.level_after;
  json["change"] = shift.change ? Json(shift.change->median) : Json(nullptr);
  const std::optional<eval::Interval> interval = shift.change ? shift.change->interval : std::nullopt;
  json["interval"] = interval ? Json({interval->low, interval->high}) : Json(nullptr);
  json["n"] = shift.change ? Json(shift.change->count) : Json(nullptr);
  json["p_value"] = shift.p_value;
  return json;
}

Json drift_json(const bench::CommitHistory& history, const bench::MetricDrift& drift) {
  Json json = subject_json(history, history.series[drift.series]);
  json["from_commit"] = clean_line(history.commits[drift.first].name);
  json["to_commit"] = clean_line(history.commits[drift.last].name);
  json["change"] = drift.change;
  json["p_value"] = drift.p_value;
  return json;
}

std::string group_row(const bench::CommitHistory& history, const ShiftGroup& group) {
  const bench::LevelShift& largest = *group.shifts.front();
  const bench::HistorySeries& series = history.series[largest.series];
  return fmt::format("| {} | {}..{} | {} | {} | {} to {} | {} | {} |\n", escape_markdown(group.metric),
                     escape_markdown(commit_label(history.commits[group.before].name)),
                     escape_markdown(commit_label(history.commits[group.after].name)), group.shifts.size(),
                     escape_markdown(subject_label(series.subject)),
                     escape_markdown(value_label(largest.level_before, series.unit)),
                     escape_markdown(value_label(largest.level_after, series.unit)), change_label(largest),
                     interval_label(largest));
}

std::string drifts_markdown(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  std::string rows;
  for (const bench::MetricDrift& drift : changes.drifts) {
    if (!drift.worse) continue;
    const bench::HistorySeries& series = history.series[drift.series];
    rows += fmt::format("| {} | {}..{} | {} | {:+.1f} % |\n", escape_markdown(series.metric),
                        escape_markdown(commit_label(history.commits[drift.first].name)),
                        escape_markdown(commit_label(history.commits[drift.last].name)),
                        escape_markdown(subject_label(series.subject)), 100.0 * drift.change);
  }
  if (rows.empty()) return "";
  return "\nDrift over commits (not counted as regressions):\n\n| metric | commits | on | total change "
         "|\n|---|---|---|---:|\n" +
         rows;
}

}  // namespace

std::vector<ShiftGroup> grouped_shifts(const bench::CommitHistory& history,
                                       const bench::HistoryChanges& changes, bench::ChangeState state) {
  std::vector<ShiftGroup> groups;
  for (const bench::LevelShift& shift : changes.shifts) {
    if (shift.state != state) continue;
    const std::string& metric = history.series[shift.series].metric;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const ShiftGroup& known) {
      return known.metric == metric && known.before == shift.before && known.after == shift.after;
    });
    if (group == groups.end()) group = groups.insert(groups.end(), {metric, shift.before, shift.after, {}});
    group->shifts.push_back(&shift);
  }
  for (ShiftGroup& group : groups) {
    std::stable_sort(
        group.shifts.begin(), group.shifts.end(),
        [](const bench::LevelShift* a, const bench::LevelShift* b) { return magnitude(*a) > magnitude(*b); });
  }
  std::stable_sort(groups.begin(), groups.end(), [](const ShiftGroup& a, const ShiftGroup& b) {
    return a.after != b.after ? a.after > b.after
                              : magnitude(*a.shifts.front()) > magnitude(*b.shifts.front());
  });
  return groups;
}

std::string regressions_markdown(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  const std::vector<ShiftGroup> groups = grouped_shifts(history, changes, bench::ChangeState::kOpen);
  std::string text = "No open regressions.\n";
  if (!groups.empty()) {
    text =
        "| metric | between commits | series | largest change on | before, after | change | n, 95 % interval "
        "|\n"
        "|---|---|---:|---|---|---:|---|\n";
    for (const ShiftGroup& group : groups) text += group_row(history, group);
  }
  return text + drifts_markdown(history, changes);
}

std::string regressions_json(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  Json json = {{"open", Json::array()}, {"drifting", Json::array()}};
  for (const ShiftGroup& group : grouped_shifts(history, changes, bench::ChangeState::kOpen)) {
    for (const bench::LevelShift* shift : group.shifts) json["open"].push_back(shift_json(history, *shift));
  }
  for (const bench::MetricDrift& drift : changes.drifts) {
    if (drift.worse) json["drifting"].push_back(drift_json(history, drift));
  }
  return json.dump(2) + "\n";
}

}  // namespace stillpoint::report
