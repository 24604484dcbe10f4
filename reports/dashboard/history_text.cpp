// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/history_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "core/base/content_hash.h"
#include "core/base/counted.h"
#include "core/base/module_timings.h"
#include "reports/dashboard/headline.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

constexpr std::size_t kHashDigits = 10;
constexpr std::size_t kMaxCharacters = 24;

bool is_git_hash(const std::string& text) {
  return text.size() == 40 && std::all_of(text.begin(), text.end(),
                                          [](unsigned char letter) { return std::isxdigit(letter) != 0; });
}

/// The first `count` characters of valid UTF-8 text.
std::string first_characters(const std::string& text, std::size_t count) {
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    const bool starts_character = (static_cast<unsigned char>(text[end]) & 0xC0) != 0x80;
    if (starts_character && count-- == 0) return text.substr(0, end);
  }
  return text;
}

}  // namespace

std::string commit_label(const std::string& name) {
  const std::size_t plus = name.find('+');
  std::string base = name.substr(0, plus);
  if (is_git_hash(base)) base.resize(kHashDigits);
  return first_characters(clean_line(plus == std::string::npos ? base : base + name.substr(plus)),
                          kMaxCharacters);
}

std::string subject_label(const bench::HistorySubject& subject) {
  std::string label = clean_line(subject.variant) + " on " + clean_line(subject.sequence);
  if (!subject.axis.empty()) label += fmt::format(", {} = {}", clean_line(subject.axis), subject.axis_value);
  if (subject.seed != 1) label += fmt::format(", seed {}", subject.seed);
  if (subject.mode != "sequential") label += ", " + clean_line(subject.mode);
  if (subject.kind != "accuracy") label += ", " + clean_line(subject.kind);
  if (!subject.cores.empty()) label += ", cores " + clean_line(subject.cores);
  return label;
}

std::string change_label(const bench::LevelShift& shift) {
  if (!shift.missing.empty()) return shift.missing;
  return shift.change ? percent_text(shift.change->median) : "new";
}

std::string interval_label(const bench::LevelShift& shift) {
  return shift.change ? interval_text(*shift.change) : "";
}

std::string value_label(double value, const std::string& unit) {
  if (std::isnan(value)) return "missing";
  return fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", clean_line(unit));
}

namespace {

using Json = nlohmann::ordered_json;

/// Rounds to 6 significant digits, the precision of the charts, to keep the page small.
double rounded(double value) { return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr); }

/// Assigns indices to names in order of first appearance.
class NameTable {
 public:
  std::size_t index(const std::string& name) {
    const auto [entry, is_new] = indices_.insert({name, names_.size()});
    if (is_new) names_.push_back(clean_line(name));
    return entry->second;
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::map<std::string, std::size_t> indices_;
  std::vector<std::string> names_;
};

std::string family_name(bench::MetricFamily family) {
  return family == bench::MetricFamily::kAccuracy ? "accuracy" : "cost";
}

/// Metrics that the charts show first, by family: the first that a subject has.
Json preferred_json() {
  Json json = {{"accuracy", Json::array()}, {"cost", Json::array()}};
  for (const bench::MetricDescriptor& metric : bench::all_metrics()) {
    if (!metric.gate) continue;
    const bool is_module = metric.id == bench::metric_id::kModuleTime;
    json[family_name(metric.gate->family)].push_back(
        std::string(is_module ? module_name(Module::kStateOptimization) : metric.id));
  }
  return json;
}

Json tooltips_json(const bench::CommitHistory& history) {
  Json json = Json::object();
  for (const bench::HistorySeries& series : history.series)
    json[clean_line(series.metric)] = bench::tooltip_of(series.metric);
  return json;
}

Json commits_json(const std::vector<bench::Commit>& commits) {
  Json list = Json::array();
  for (const bench::Commit& commit : commits) {
    Json& json = list.emplace_back(Json{{"name", clean_line(commit.name)},
                                        {"label", commit_label(commit.name)},
                                        {"time", clean_line(commit.time)},
                                        {"page", commit_file(commit)}});
    if (!commit.subject.empty()) json["subject"] = clean_line(commit.subject);
  }
  return list;
}

Json series_json(const bench::HistorySeries& series, std::size_t subject) {
  Json values = Json::array();
  for (const double value : series.values) values.push_back(rounded(value));
  return {{"subject", subject},
          {"metric", clean_line(series.metric)},
          {"unit", clean_line(series.unit)},
          {"family", series.gated == nullptr ? "other" : family_name(series.gated->gate->family)},
          {"commits", series.commits},
          {"values", values},
          {"runs", series.runs}};
}

Json shift_json(const bench::LevelShift& shift) {
  Json json = {{"series", shift.series},
               {"before", shift.before},
               {"after", shift.after},
               {"from", rounded(shift.level_before)},
               {"to", rounded(shift.missing.empty() ? shift.level_after : shift.level_before)},
               {"change", change_label(shift)},
               {"interval", interval_label(shift)},
               {"state", bench::state_name(shift.state)}};
  if (!shift.reason.empty()) json["reason"] = clean_line(shift.reason);
  return json;
}

Json drifts_json(const std::vector<bench::MetricDrift>& found) {
  Json drifts = Json::array();
  for (const bench::MetricDrift& drift : found) {
    drifts.push_back({{"series", drift.series},
                      {"first", drift.first},
                      {"last", drift.last},
                      {"from", rounded(drift.start)},
                      {"to", rounded(drift.end)},
                      {"worse", drift.worse}});
  }
  return drifts;
}

}  // namespace

std::string commit_file(const bench::Commit& commit) {
  std::string name;
  for (const char letter : commit.name.substr(0, 12)) {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0) name += letter;
  }
  return "commits/" + name + "-" + hash_text(content_hash(commit.name)) + ".html";
}

std::vector<bench::HistorySubject> subjects_of(const bench::CommitHistory& history) {
  std::vector<bench::HistorySubject> subjects;
  for (const bench::HistorySeries& series : history.series) {
    if (subjects.empty() || subjects.back() != series.subject) subjects.push_back(series.subject);
  }
  return subjects;
}

std::string dashboard_data(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  NameTable plans;
  NameTable hosts;
  Json subjects = Json::array();
  for (const bench::HistorySubject& subject : subjects_of(history)) {
    subjects.push_back({{"label", subject_label(subject)},
                        {"data", clean_line(subject.sequence_id)},
                        {"host", hosts.index(subject.host)},
                        {"plans", Json::array()}});
  }
  Json all_series = Json::array();
  std::size_t subject = 0;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const bench::HistorySeries& series = history.series[i];
    if (i > 0 && series.subject != history.series[i - 1].subject) ++subject;
    all_series.push_back(series_json(series, subject));
    if (!subjects[subject]["plans"].empty()) continue;
    for (const std::string& plan : series.plans) subjects[subject]["plans"].push_back(plans.index(plan));
  }
  Json shifts = Json::array();
  for (const bench::LevelShift& shift : changes.shifts) shifts.push_back(shift_json(shift));
  const Json json = {{"commits", commits_json(history.commits)},
                     {"plans", plans.all()},
                     {"hosts", hosts.all()},
                     {"subjects", subjects},
                     {"preferred", preferred_json()},
                     {"tooltips", tooltips_json(history)},
                     {"series", all_series},
                     {"shifts", shifts},
                     {"drifts", drifts_json(changes.drifts)}};
  return json.dump();
}

namespace {

/// Size in margins; newly failing runs and missing results rank above any change of a metric.
double size_of(const bench::CommitHistory& history, const bench::LevelShift& shift) {
  const bench::MetricDescriptor* gated = history.series[shift.series].gated;
  if (!shift.change) return std::numeric_limits<double>::infinity();
  return gated == nullptr ? 0.0 : bench::size_in_margins(shift.level_before, shift.level_after, *gated);
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

Json regression_json(const bench::CommitHistory& history, const bench::LevelShift& shift) {
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
  json["missing"] = shift.missing.empty() ? Json(nullptr) : Json(shift.missing);
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

/// Label, with its link, and subject.
std::string commit_markdown(const bench::Commit& commit) {
  std::string text = escape_markdown(commit_label(commit.name));
  if (!commit.link.empty()) text = "[" + text + "](" + commit.link + ")";
  return commit.subject.empty() ? text : text + " " + escape_markdown(commit.subject);
}

std::string group_row(const bench::CommitHistory& history, const ShiftGroup& group) {
  const bench::LevelShift& largest = *group.shifts.front();
  const bench::HistorySeries& series = history.series[largest.series];
  return fmt::format("| {} | {}..{} | {} | {} | {} to {} | {} | {} |\n", escape_markdown(group.metric),
                     escape_markdown(commit_label(history.commits[group.before].name)),
                     commit_markdown(history.commits[group.after]), group.shifts.size(),
                     escape_markdown(subject_label(series.subject)),
                     escape_markdown(value_label(largest.level_before, series.unit)),
                     escape_markdown(value_label(largest.level_after, series.unit)), change_label(largest),
                     interval_label(largest));
}

std::string drifts_markdown(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  std::string rows;
  for (const bench::MetricDrift& drift : changes.drifts) {
    if (!drift.is_open()) continue;
    const bench::HistorySeries& series = history.series[drift.series];
    rows += fmt::format("| {} | {}..{} | {} | {:+.1f} % |\n", escape_markdown(series.metric),
                        escape_markdown(commit_label(history.commits[drift.first].name)),
                        escape_markdown(commit_label(history.commits[drift.last].name)),
                        escape_markdown(subject_label(series.subject)), 100.0 * drift.change);
  }
  if (rows.empty()) return "";
  return "\nDrift for the worse, beyond the margin in sum:\n\n| metric | commits | on | total change "
         "|\n|---|---|---|---:|\n" +
         rows;
}

constexpr std::size_t kMaxMarkdownRows = 10;  // rows of the Markdown; the dashboard has more

std::string suspected_markdown(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  const std::vector<bench::SuspectedChange> suspected = bench::suspected_changes(history, changes);
  if (suspected.empty()) return "";
  std::string rows;
  for (std::size_t i = 0; i < std::min(suspected.size(), kMaxMarkdownRows); ++i) {
    const bench::SuspectedChange& change = suspected[i];
    const bench::HistorySeries& series = history.series[change.series];
    rows += fmt::format("| {} | {} | {} | {} to {} | {} | {} |\n", escape_markdown(series.metric),
                        commit_markdown(history.commits[change.after]),
                        escape_markdown(subject_label(series.subject)),
                        escape_markdown(value_label(change.level_before, series.unit)),
                        escape_markdown(value_label(change.level_after, series.unit)),
                        change.worse ? "worse" : "better", p_label(change));
  }
  const std::string left = suspected.size() > kMaxMarkdownRows
                               ? fmt::format("\n{} more.\n", suspected.size() - kMaxMarkdownRows)
                               : "";
  return "\nSuspected, not confirmed:\n\n| metric | since | on | before, after | | p |\n"
         "|---|---|---|---|---|---:|\n" +
         rows + left;
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
    std::stable_sort(group.shifts.begin(), group.shifts.end(),
                     [&](const bench::LevelShift* a, const bench::LevelShift* b) {
                       return size_of(history, *a) > size_of(history, *b);
                     });
  }
  std::ranges::stable_sort(groups, [&](const ShiftGroup& a, const ShiftGroup& b) {
    const bench::LevelShift& first = *a.shifts.front();
    const bench::LevelShift& second = *b.shifts.front();
    return bench::precedes(history.series[first.series].gated, size_of(history, first),
                           history.series[second.series].gated, size_of(history, second));
  });
  return groups;
}

bool has_findings(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  return !grouped_shifts(history, changes, bench::ChangeState::kOpen).empty() ||
         std::ranges::any_of(changes.drifts, &bench::MetricDrift::is_open);
}

std::string tested_sentence(const bench::CommitHistory& history) {
  constexpr std::size_t kTestable =
      40;  // commits from which on a step of a noisy metric is found after three
  std::size_t tested = 0;
  std::size_t is_short = 0;
  for (const bench::HistorySeries& series : history.series) {
    if (series.gated == nullptr || series.metric == bench::metric_id::kFailedRuns) continue;
    ++tested;
    is_short += series.values.size() < kTestable ? 1 : 0;
  }
  std::string text = fmt::format("Tested: {} series of compared metrics over {}", tested,
                                 counted(history.commits.size(), "commit"));
  if (is_short > 0) {
    text += fmt::format(
        "; {} of them have fewer than {} commits: they show failures, missing results, and steps of metrics "
        "without "
        "noise that three commits confirm, but few steps of noisy ones",
        is_short, kTestable);
  }
  return text + ".";
}

std::string regressions_markdown(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  const std::vector<ShiftGroup> groups = grouped_shifts(history, changes, bench::ChangeState::kOpen);
  std::string text = escape_markdown(headline(history, changes)) + "\n";
  if (!groups.empty()) {
    text +=
        "\n| metric | between commits | series | largest change on | before, after | change | n, 95 % "
        "interval "
        "|\n"
        "|---|---|---:|---|---|---:|---|\n";
    for (const ShiftGroup& group : groups) text += group_row(history, group);
  }
  return text + drifts_markdown(history, changes) + suspected_markdown(history, changes) + "\n" +
         tested_sentence(history) + "\n";
}

std::string regressions_json(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  Json json = {{"schema", 1}, {"open", Json::array()}, {"drifting", Json::array()}};
  for (const ShiftGroup& group : grouped_shifts(history, changes, bench::ChangeState::kOpen)) {
    for (const bench::LevelShift* shift : group.shifts)
      json["open"].push_back(regression_json(history, *shift));
  }
  for (const bench::MetricDrift& drift : changes.drifts) {
    if (drift.is_open()) json["drifting"].push_back(drift_json(history, drift));
  }
  return json.dump(2) + "\n";
}

}  // namespace stillpoint::report
