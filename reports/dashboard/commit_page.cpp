// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/commit_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "reports/dashboard/dashboard_data.h"
#include "reports/dashboard/history_text.h"
#include "reports/page/embedded_web.h"
#include "reports/page/html_parts.h"
#include "reports/tables/escaping.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMostRows = 300;  // the largest differences; all numbers are on the first page

/// A number of this commit and the one measured before it.
struct BeforeAfter {
  const HistorySeries* series = nullptr;
  std::size_t commit_before = 0;
  double before = 0.0;
  double after = 0.0;

  /// Relative; what was 0 and is not any more comes first.
  [[nodiscard]] double difference() const {
    if (before == after) return 0.0;
    return before == 0.0 ? std::numeric_limits<double>::infinity() : (after - before) / std::abs(before);
  }
};

/// Of the metrics that have a good direction.
std::vector<BeforeAfter> numbers_of(const CommitHistory& history, std::size_t commit) {
  std::vector<BeforeAfter> numbers;
  for (const HistorySeries& series : history.series) {
    const auto found = std::lower_bound(series.commits.begin(), series.commits.end(), commit);
    if (!series.rule || found == series.commits.end() || *found != commit || found == series.commits.begin())
      continue;
    const auto i = static_cast<std::size_t>(found - series.commits.begin());
    numbers.push_back({&series, series.commits[i - 1], series.values[i - 1], series.values[i]});
  }
  std::stable_sort(numbers.begin(), numbers.end(), [](const BeforeAfter& a, const BeforeAfter& b) {
    return std::abs(a.difference()) > std::abs(b.difference());
  });
  return numbers;
}

std::string number_row(const CommitHistory& history, const BeforeAfter& number) {
  const HistorySeries& series = *number.series;
  const double difference = number.difference();
  return fmt::format(
      "<tr><th scope=\"row\">{}</th><td class=\"from\">{}</td><td "
      "class=\"from\">{}</td><td class=\"from\">{}</td><td>{}</td>"
      "<td>{}</td><td>{}</td></tr>\n",
      escape_html(series.metric), escape_html(subject_label(series.subject)),
      escape_html(series.subject.host), escape_html(commit_label(history.commits[number.commit_before].name)),
      escape_html(number_label(number.before, series.unit)),
      escape_html(number_label(number.after, series.unit)),
      std::isfinite(difference) ? fmt::format("{:+.1f} %", 100.0 * difference) : "new");
}

std::string numbers_html(const CommitHistory& history, std::size_t commit) {
  const std::vector<BeforeAfter> numbers = numbers_of(history, commit);
  if (numbers.empty()) return "<p class=\"none\">No number of this commit was measured before it.</p>";
  std::string rows;
  for (std::size_t i = 0; i < std::min(numbers.size(), kMostRows); ++i)
    rows += number_row(history, numbers[i]);
  const std::string left =
      numbers.size() > kMostRows
          ? fmt::format("; the {} smallest differences are left out", numbers.size() - kMostRows)
          : "";
  return html_table("numbers",
                    fmt::format("{} numbers, the largest difference first{}", numbers.size(), left),
                    {{"metric", true},
                     {"on", true},
                     {"machine", true},
                     {"commit before", true},
                     {"before"},
                     {"here"},
                     {"difference"}},
                    rows);
}

std::string shift_row(const CommitHistory& history, const LevelShift& shift) {
  const HistorySeries& series = history.series[shift.series];
  return fmt::format(
      "<tr class=\"{0}\"><th scope=\"row\"><a href=\"../index.html#series={1}\">{2}</a></th>"
      "<td class=\"from\">{3}</td><td>{4}</td><td>{5}</td><td>{6}</td><td>{7}</td><td "
      "class=\"from\">{0}{8}</td>"
      "</tr>\n",
      state_name(shift.state), shift.series, escape_html(series.metric),
      escape_html(subject_label(series.subject)), escape_html(number_label(shift.level_before, series.unit)),
      escape_html(number_label(shift.level_after, series.unit)), change_label(shift), interval_label(shift),
      shift.reason.empty() ? "" : ": " + escape_html(shift.reason));
}

std::string shifts_html(const CommitHistory& history, const HistoryChanges& changes, std::size_t commit) {
  std::string rows;
  for (const LevelShift& shift : changes.shifts) {
    if (shift.after == commit) rows += shift_row(history, shift);
  }
  if (rows.empty()) return "<p class=\"none\">No level changed here.</p>";
  return html_table(
      "shifts", "Levels before and after, medians over their commits",
      {{"metric", true}, {"on", true}, {"before"}, {"after"}, {"change"}, {"95 % interval"}, {"state", true}},
      rows);
}

/// Links lead from page to page; all lie in one folder.
std::string link_to(const CommitHistory& history, std::size_t commit, const std::string& what) {
  if (commit >= history.commits.size()) return "";
  const Commit& target = history.commits[commit];
  return fmt::format("<a href=\"{}\">{} {}</a> ",
                     std::filesystem::path(commit_file(target)).filename().string(), what,
                     escape_html(commit_label(target.name)));
}

}  // namespace

std::string commit_html(const CommitHistory& history, const HistoryChanges& changes, std::size_t commit) {
  const Commit& subject = history.commits[commit];
  const std::size_t before = commit == 0 ? history.commits.size() : commit - 1;
  return filled_template(
      web_file("dashboard/commit.html"),
      {{"title", escape_html(commit_label(subject.name))},
       {"name", escape_html(subject.name)},
       {"time", escape_html(subject.time)},
       {"styles", std::string(web_file("page.css")) + std::string(web_file("dashboard/dashboard.css"))},
       {"neighbours", link_to(history, before, "before:") + link_to(history, commit + 1, "after:")},
       {"shifts", shifts_html(history, changes, commit)},
       {"numbers", numbers_html(history, commit)}});
}

}  // namespace stillpoint
