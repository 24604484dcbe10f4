// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/commit_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "reports/dashboard/dashboard_data.h"
#include "reports/dashboard/history_text.h"
#include "reports/page/html_parts.h"
#include "reports/tables/escaping.h"

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
       {"styles", std::string(web_file("page.css")) + std::string(web_file("dashboard/dashboard.css"))},
       {"neighbors", link_to(history, before, "previous:") + link_to(history, commit + 1, "next:")},
       {"shifts", shifts_html(history, changes, commit)},
       {"metrics", differences_html(history, commit)}});
}

}  // namespace stillpoint::report
