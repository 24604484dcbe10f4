// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/dashboard.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/analysis/run_groups.h"
#include "bench/model/metrics.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "reports/dashboard/headline.h"
#include "reports/dashboard/history_text.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

constexpr std::size_t kMaxRows = 300;  // the largest differences; the index page has all metrics

/// A metric at this commit and at the previous measured commit.
struct MetricDifference {
  const bench::HistorySeries* series = nullptr;
  std::size_t previous_commit = 0;
  double before = 0.0;
  double after = 0.0;

  /// Relative difference; infinite where the previous value is 0, so that it sorts first.
  [[nodiscard]] double difference() const {
    if (before == after) return 0.0;
    return before == 0.0 ? std::numeric_limits<double>::infinity() : (after - before) / std::abs(before);
  }
};

/// Differences of the metrics that have a preferred direction, largest first.
std::vector<MetricDifference> differences_at(const bench::CommitHistory& history, std::size_t commit) {
  std::vector<MetricDifference> differences;
  for (const bench::HistorySeries& series : history.series) {
    const auto found = std::lower_bound(series.commits.begin(), series.commits.end(), commit);
    if (series.gated == nullptr || found == series.commits.end() || *found != commit ||
        found == series.commits.begin())
      continue;
    const auto i = static_cast<std::size_t>(found - series.commits.begin());
    differences.push_back({&series, series.commits[i - 1], series.values[i - 1], series.values[i]});
  }
  std::stable_sort(differences.begin(), differences.end(),
                   [](const MetricDifference& a, const MetricDifference& b) {
                     return std::abs(a.difference()) > std::abs(b.difference());
                   });
  return differences;
}

std::string difference_row(const bench::CommitHistory& history, const MetricDifference& metric) {
  const bench::HistorySeries& series = *metric.series;
  const double difference = metric.difference();
  return fmt::format(
      "<tr>{}<td class=\"text\">{}</td><td "
      "class=\"text\">{}</td><td class=\"text\">{}</td><td>{}</td>"
      "<td>{}</td><td>{}</td></tr>\n",
      metric_heading(series.metric), escape_html(subject_label(series.subject)),
      escape_html(series.subject.host),
      escape_html(commit_label(history.commits[metric.previous_commit].name)),
      escape_html(value_label(metric.before, series.unit)),
      escape_html(value_label(metric.after, series.unit)),
      std::isfinite(difference) ? fmt::format("{:+.1f} %", 100.0 * difference) : "new");
}

std::string differences_html(const bench::CommitHistory& history, std::size_t commit) {
  const std::vector<MetricDifference> differences = differences_at(history, commit);
  if (differences.empty())
    return "<p class=\"none\">No metric of this commit has an earlier measurement.</p>";
  std::string rows;
  for (std::size_t i = 0; i < std::min(differences.size(), kMaxRows); ++i)
    rows += difference_row(history, differences[i]);
  const std::string left =
      differences.size() > kMaxRows
          ? fmt::format("; the {} smallest differences are omitted", differences.size() - kMaxRows)
          : "";
  return html_table("metric-table",
                    fmt::format("{} metrics compared with the previous measured commit, largest difference "
                                "first{}",
                                differences.size(), left),
                    {{"metric", true},
                     {"on", true},
                     {"machine", true},
                     {"previous commit", true},
                     {"previous value"},
                     {"this commit"},
                     {"difference"}},
                    rows);
}

std::string shift_row(const bench::CommitHistory& history, const bench::LevelShift& shift) {
  const bench::HistorySeries& series = history.series[shift.series];
  return fmt::format(
      "<tr class=\"{0}\"><th scope=\"row\" title=\"{9}\"><a href=\"../index.html#series={1}\">{2}</a></th>"
      "<td class=\"text\">{3}</td><td>{4}</td><td>{5}</td><td>{6}</td><td>{7}</td><td "
      "class=\"text\">{0}{8}</td>"
      "</tr>\n",
      bench::state_name(shift.state), shift.series, escape_html(series.metric),
      escape_html(subject_label(series.subject)), escape_html(value_label(shift.level_before, series.unit)),
      escape_html(value_label(shift.level_after, series.unit)), change_label(shift), interval_label(shift),
      shift.reason.empty() ? "" : ": " + escape_html(shift.reason),
      escape_html(bench::tooltip_of(series.metric)));
}

std::string shifts_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes,
                        std::size_t commit) {
  std::string rows;
  for (const bench::LevelShift& shift : changes.shifts) {
    if (shift.after == commit) rows += shift_row(history, shift);
  }
  if (rows.empty()) return "<p class=\"none\">No change points at this commit.</p>";
  return html_table("shifts",
                    "Medians over the commits before and after the change point, and the relative change",
                    {{"metric", true},
                     {"on", true},
                     {"before"},
                     {"after"},
                     {"change"},
                     {"n, 95 % interval"},
                     {"state", true}},
                    rows);
}

/// Link to the page of another commit; all pages are in one folder.
std::string link_to(const bench::CommitHistory& history, std::size_t commit, const std::string& text) {
  if (commit >= history.commits.size()) return "";
  const bench::Commit& target = history.commits[commit];
  return fmt::format("<a href=\"{}\">{} {}</a> ",
                     std::filesystem::path(commit_file(target)).filename().string(), text,
                     escape_html(commit_label(target.name)));
}

/// Subject, author date and link of a commit, as far as they are known.
std::string message_html(const bench::Commit& commit) {
  std::string text;
  if (!commit.subject.empty()) text += "<p>" + escape_html(commit.subject) + "</p>\n";
  if (!commit.authored.empty())
    text += "<p class=\"hint\">Author date: " + escape_html(commit.authored) + "</p>\n";
  if (!commit.link.empty())
    text += fmt::format("<p><a href=\"{}\">The commit at its code host</a></p>\n", escape_html(commit.link));
  return text;
}

}  // namespace

std::string commit_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes,
                        std::size_t commit) {
  const bench::Commit& subject = history.commits[commit];
  const std::size_t before = commit == 0 ? history.commits.size() : commit - 1;
  return filled_template(
      web_file("dashboard/commit.html"),
      {{"title", escape_html(commit_label(subject.name))},
       {"name", escape_html(subject.name)},
       {"time", escape_html(subject.time)},
       {"message", message_html(subject)},
       {"styles", std::string(web_file("page.css")) + std::string(web_file("dashboard/dashboard.css"))},
       {"neighbors", link_to(history, before, "previous:") + link_to(history, commit + 1, "next:")},
       {"shifts", shifts_html(history, changes, commit)},
       {"metrics", differences_html(history, commit)}});
}

namespace {

constexpr std::size_t kMaxMembers = 20;  // of a group that are listed individually
constexpr std::string_view kDashboardScripts[] = {
    "vendor/uPlot.iife.min.js", "unpack.js", "tables.js", "legend.js", "dashboard/history_charts.js",
    "dashboard/dashboard.js"};

std::string commit_link(const bench::CommitHistory& history, std::size_t commit) {
  const bench::Commit& target = history.commits[commit];
  return fmt::format("<a href=\"{}\" title=\"{}\">{}</a>", commit_file(target), escape_html(target.subject),
                     escape_html(commit_label(target.name)));
}

/// "A .. B", and the subject of the second one.
std::string between_html(const bench::CommitHistory& history, std::size_t before, std::size_t after) {
  const std::string& subject = history.commits[after].subject;
  return commit_link(history, before) + " .. " + commit_link(history, after) +
         (subject.empty() ? "" : "<span class=\"subject\">" + escape_html(subject) + "</span>");
}

std::string series_link(const bench::CommitHistory& history, std::size_t series) {
  return fmt::format("<a href=\"#series={}\">{}</a>", series,
                     escape_html(subject_label(history.series[series].subject)));
}

std::string summary_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  std::set<std::string> hosts;
  for (const bench::HistorySeries& series : history.series) hosts.insert(series.subject.host);
  std::string text = "<li>" + escape_html(headline(history, changes)) + "</li>";
  if (history.system != bench::kOwnSystem)
    text += "<li>System: " + escape_html(history.system) + "; its versions take the place of commits.</li>";
  text += fmt::format("<li>{} from {} to {}, {}, {}.</li>", counted(history.commits.size(), "commit"),
                      escape_html(history.commits.front().time), escape_html(history.commits.back().time),
                      fmt::format("{} series", history.series.size()), counted(hosts.size(), "machine type"));
  text += "<li>" + escape_html(tested_sentence(history)) + "</li>";
  return "<ul class=\"summary\">" + text + "</ul>";
}

/// The other members of a group, collapsed below its largest.
std::string members_html(const bench::CommitHistory& history, const ShiftGroup& group) {
  if (group.shifts.size() < 2) return "";
  std::string items;
  for (std::size_t i = 1; i < std::min(group.shifts.size(), kMaxMembers); ++i) {
    items += "<li>" + series_link(history, group.shifts[i]->series) + " " + change_label(*group.shifts[i]) +
             "</li>";
  }
  const std::string left = group.shifts.size() > kMaxMembers
                               ? fmt::format("<li>{} more</li>", group.shifts.size() - kMaxMembers)
                               : "";
  return fmt::format("<details><summary>and {} more series</summary><ul>{}{}</ul></details>",
                     group.shifts.size() - 1, items, left);
}

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
  return quoted + "'";
}

/// The command that accepts an open regression, and its size in margins.
std::string accept_html(const bench::CommitHistory& history, const ShiftGroup& group) {
  const bench::LevelShift& largest = *group.shifts.front();
  const bench::HistorySeries& series = history.series[largest.series];
  const std::string size =
      largest.change && series.gated != nullptr
          ? fmt::format("{:.1f} margins",
                        bench::size_in_margins(largest.level_before, largest.level_after, *series.gated))
          : "";
  const std::string command = fmt::format(
      "stillpoint store accept {} --metric {} --reason 'WHY' --store STORE",
      shell_quoted(clean_line(history.commits[group.after].name)), shell_quoted(clean_line(group.metric)));
  return size + "<details><summary>accept</summary><code>" + escape_html(command) + "</code></details>";
}

std::string change_row(const bench::CommitHistory& history, const ShiftGroup& group) {
  const bench::LevelShift& largest = *group.shifts.front();
  const bench::HistorySeries& series = history.series[largest.series];
  return fmt::format(
      "<tr>{}<td class=\"text\">{}</td><td class=\"text\">{}{}</td>"
      "<td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td "
      "class=\"text\">{}</td></tr>\n",
      metric_heading(group.metric), between_html(history, group.before, group.after),
      series_link(history, largest.series), members_html(history, group), escape_html(series.subject.host),
      escape_html(value_label(largest.level_before, series.unit)),
      escape_html(value_label(largest.level_after, series.unit)), change_label(largest),
      interval_label(largest),
      largest.state == bench::ChangeState::kOpen ? accept_html(history, group) : escape_html(largest.reason));
}

std::string groups_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes,
                        bench::ChangeState state, const std::string& none) {
  const std::vector<ShiftGroup> groups = grouped_shifts(history, changes, state);
  if (groups.empty()) return "<p class=\"none\">" + none + "</p>";
  std::string rows;
  for (const ShiftGroup& group : groups) rows += change_row(history, group);
  return html_table(bench::state_name(state) + "-changes", "",
                    {{"metric", true},
                     {"between commits", true},
                     {"largest change on", true},
                     {"machine", true},
                     {"before"},
                     {"after"},
                     {"change"},
                     {"n, 95 % interval"},
                     {state == bench::ChangeState::kAccepted ? "reason"
                      : state == bench::ChangeState::kOpen   ? "size"
                                                             : "",
                      true}},
                    rows);
}

constexpr std::size_t kMaxSuspected = 100;  // rows; the largest

std::string suspected_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  const std::vector<bench::SuspectedChange> suspected = bench::suspected_changes(history, changes);
  if (suspected.empty()) return "<p class=\"none\">None.</p>";
  std::string rows;
  for (std::size_t i = 0; i < std::min(suspected.size(), kMaxSuspected); ++i) {
    const bench::SuspectedChange& change = suspected[i];
    const bench::HistorySeries& series = history.series[change.series];
    rows += fmt::format(
        "<tr>{}<td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td>"
        "<td>{}</td><td>{}</td><td>{:.1f}</td><td>{} + {}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
        metric_heading(series.metric), between_html(history, change.before, change.after),
        series_link(history, change.series), escape_html(series.subject.host),
        escape_html(value_label(change.level_before, series.unit)),
        escape_html(value_label(change.level_after, series.unit)),
        bench::size_in_margins(change.level_before, change.level_after, *series.gated), change.count_before,
        change.count_after, p_label(change), change.worse ? "worse" : "better");
  }
  const std::string left = suspected.size() > kMaxSuspected
                               ? fmt::format("{} smaller ones are omitted", suspected.size() - kMaxSuspected)
                               : "";
  return html_table("suspected-changes", left,
                    {{"metric", true},
                     {"between commits", true},
                     {"on", true},
                     {"machine", true},
                     {"before"},
                     {"after"},
                     {"size [margins]"},
                     {"commits"},
                     {"p"},
                     {"direction", true}},
                    rows);
}

std::string drifts_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  std::string rows;
  for (const bench::MetricDrift& drift : changes.drifts) {
    const bench::HistorySeries& series = history.series[drift.series];
    rows += fmt::format(
        "<tr>{}<td class=\"text\">{}</td><td class=\"text\">{} .. {}</td><td>{:+.1f} "
        "%</td>"
        "<td class=\"text\">{}</td></tr>\n",
        metric_heading(series.metric), series_link(history, drift.series), commit_link(history, drift.first),
        commit_link(history, drift.last), 100.0 * drift.change, drift.worse ? "worse" : "better");
  }
  if (rows.empty()) return "<p class=\"none\">No metric drifts by more than its margin.</p>";
  return html_table(
      "drifts", "",
      {{"metric", true}, {"on", true}, {"commits", true}, {"total change"}, {"direction", true}}, rows);
}

std::set<std::string> metric_names(const bench::CommitHistory& history) {
  std::set<std::string> names;
  for (const bench::HistorySeries& series : history.series) names.insert(series.metric);
  return names;
}

std::string index_html(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  std::string styles;
  for (const char* name : {"vendor/uPlot.min.css", "page.css", "dashboard/dashboard.css"})
    styles += web_file(name);
  return filled_template(
      web_file("dashboard/dashboard.html"),
      {{"styles", styles},
       {"summary", summary_html(history, changes)},
       {"glossary", glossary_html(metric_names(history))},
       {"open", groups_html(history, changes, bench::ChangeState::kOpen, "None.")},
       {"suspected", suspected_html(history, changes)},
       {"accepted", groups_html(history, changes, bench::ChangeState::kAccepted, "None.")},
       {"improved", groups_html(history, changes, bench::ChangeState::kImproved, "None.")},
       {"resolved", groups_html(history, changes, bench::ChangeState::kResolved, "None.")},
       {"drifts", drifts_html(history, changes)},
       {"licenses", preformatted(std::string(web_file("vendor/LICENSE.uPlot")))},
       {"data", data_script("index", dashboard_data(history, changes)) + data_script("files", "[]")},
       {"scripts", scripts_html(kDashboardScripts)}});
}

}  // namespace

AnalyzedHistory analyze_history(const bench::Store& store, const std::string& system,
                                const DescribeCommits& describe) {
  AnalyzedHistory analyzed{.history = bench::commit_history(store, system), .changes = {}};
  if (analyzed.history.commits.empty()) {
    const std::vector<std::string> others = bench::systems_of(store);
    throw InputError(
        store.file().string(),
        "contains no finished runs of stillpoint; " +
            (others.empty() ? "create some with `stillpoint bench PLAN --store FILE`"
                            : fmt::format("choose a system by --system: {}", fmt::join(others, ", "))));
  }
  if (describe) describe(analyzed.history.commits);
  analyzed.changes = bench::history_changes(analyzed.history, store.acceptances());
  return analyzed;
}

std::vector<bench::OutputFile> dashboard_files(const bench::Store& store, const std::string& system,
                                               const DescribeCommits& describe) {
  const auto [history, changes] = analyze_history(store, system, describe);
  std::vector<bench::OutputFile> files = {{"index.html", index_html(history, changes)},
                                          {"regressions.md", regressions_markdown(history, changes)},
                                          {"regressions.json", regressions_json(history, changes)},
                                          {"badge.svg", badge_svg(history, changes)}};
  for (std::size_t i = 0; i < history.commits.size(); ++i)
    files.push_back({commit_file(history.commits[i]), commit_html(history, changes, i)});
  return files;
}

}  // namespace stillpoint::report
