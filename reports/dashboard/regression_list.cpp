// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/regression_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/dashboard/history_text.h"
#include "reports/tables/escaping.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

/// New failures come before any change of a number.
double size_of(const LevelShift& shift) {
  return shift.change ? std::abs(shift.change->median) : std::numeric_limits<double>::infinity();
}

Json subject_json(const CommitHistory& history, const HistorySeries& series) {
  const HistorySubject& subject = series.subject;
  Json json = {{"metric", clean_line(series.metric)},      {"variant", clean_line(subject.variant)},
               {"sequence", clean_line(subject.sequence)}, {"seed", subject.seed},
               {"mode", clean_line(subject.mode)},         {"kind", clean_line(subject.kind)},
               {"host", clean_line(subject.host)}};
  if (!subject.axis.empty())
    json["sweep"] = {{"axis", clean_line(subject.axis)}, {"value", subject.axis_value}};
  json["newest_commit"] = clean_line(history.commits[series.commits.back()].name);
  return json;
}

Json shift_json(const CommitHistory& history, const LevelShift& shift) {
  const HistorySeries& series = history.series[shift.series];
  Json json = subject_json(history, series);
  json["after_commit"] = clean_line(history.commits[shift.before].name);
  json["up_to_commit"] = clean_line(history.commits[shift.after].name);
  json["unit"] = clean_line(series.unit);
  json["before"] = shift.level_before;
  json["after"] = shift.level_after;
  json["change"] = shift.change ? Json(shift.change->median) : Json(nullptr);
  json["interval"] =
      shift.change ? Json({shift.change->interval.low, shift.change->interval.high}) : Json(nullptr);
  json["p_value"] = shift.p_value;
  return json;
}

Json creep_json(const CommitHistory& history, const Creep& creep) {
  Json json = subject_json(history, history.series[creep.series]);
  json["from_commit"] = clean_line(history.commits[creep.first].name);
  json["to_commit"] = clean_line(history.commits[creep.last].name);
  json["change"] = creep.change;
  json["p_value"] = creep.p_value;
  return json;
}

std::string group_row(const CommitHistory& history, const ShiftGroup& group) {
  const LevelShift& largest = *group.shifts.front();
  const HistorySeries& series = history.series[largest.series];
  return fmt::format("| {} | {}..{} | {} | {} | {} to {} | {} | {} |\n", escape_markdown(group.metric),
                     escape_markdown(commit_label(history.commits[group.before].name)),
                     escape_markdown(commit_label(history.commits[group.after].name)), group.shifts.size(),
                     escape_markdown(subject_label(series.subject)),
                     escape_markdown(number_label(largest.level_before, series.unit)),
                     escape_markdown(number_label(largest.level_after, series.unit)), change_label(largest),
                     interval_label(largest));
}

std::string creeps_markdown(const CommitHistory& history, const HistoryChanges& changes) {
  std::string rows;
  for (const Creep& creep : changes.creeps) {
    if (!creep.worse) continue;
    const HistorySeries& series = history.series[creep.series];
    rows += fmt::format("| {} | {}..{} | {} | {:+.1f} % |\n", escape_markdown(series.metric),
                        escape_markdown(commit_label(history.commits[creep.first].name)),
                        escape_markdown(commit_label(history.commits[creep.last].name)),
                        escape_markdown(subject_label(series.subject)), 100.0 * creep.change);
  }
  if (rows.empty()) return "";
  return "\nCreeping, by little at each commit (shown, not counted):\n\n| metric | commits | on | in all "
         "|\n|---|---|---|---:|\n" +
         rows;
}

}  // namespace

std::vector<ShiftGroup> grouped_shifts(const CommitHistory& history, const HistoryChanges& changes,
                                       ChangeState state) {
  std::vector<ShiftGroup> groups;
  for (const LevelShift& shift : changes.shifts) {
    if (shift.state != state) continue;
    const std::string& metric = history.series[shift.series].metric;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const ShiftGroup& known) {
      return known.metric == metric && known.before == shift.before && known.after == shift.after;
    });
    if (group == groups.end()) group = groups.insert(groups.end(), {metric, shift.before, shift.after, {}});
    group->shifts.push_back(&shift);
  }
  for (ShiftGroup& group : groups) {
    std::stable_sort(group.shifts.begin(), group.shifts.end(),
                     [](const LevelShift* a, const LevelShift* b) { return size_of(*a) > size_of(*b); });
  }
  std::stable_sort(groups.begin(), groups.end(), [](const ShiftGroup& a, const ShiftGroup& b) {
    return a.after != b.after ? a.after > b.after : size_of(*a.shifts.front()) > size_of(*b.shifts.front());
  });
  return groups;
}

std::string regressions_markdown(const CommitHistory& history, const HistoryChanges& changes) {
  const std::vector<ShiftGroup> groups = grouped_shifts(history, changes, ChangeState::kOpen);
  std::string text = "No open regressions.\n";
  if (!groups.empty()) {
    text =
        "| metric | commits | series | largest on | from, to | change | 95 % interval |\n"
        "|---|---|---:|---|---|---:|---|\n";
    for (const ShiftGroup& group : groups) text += group_row(history, group);
  }
  return text + creeps_markdown(history, changes);
}

std::string regressions_json(const CommitHistory& history, const HistoryChanges& changes) {
  Json json = {{"open", Json::array()}, {"creeping", Json::array()}};
  for (const ShiftGroup& group : grouped_shifts(history, changes, ChangeState::kOpen)) {
    for (const LevelShift* shift : group.shifts) json["open"].push_back(shift_json(history, *shift));
  }
  for (const Creep& creep : changes.creeps) {
    if (creep.worse) json["creeping"].push_back(creep_json(history, creep));
  }
  return json.dump(2) + "\n";
}

}  // namespace stillpoint
