// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/headline.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/counted.h"
#include "reports/dashboard/history_text.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {

std::string p_label(const bench::SuspectedChange& change) {
  return change.is_exact ? "exact" : fmt::format("{:.2g}", change.p_value);
}

namespace {

constexpr std::size_t kConfirmable = 40;  // commits; see `tested_sentence`

std::string visible_sentence(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  std::string text;
  for (const auto& [family, name] : {std::pair{bench::MetricFamily::kAccuracy, "accuracy"},
                                     std::pair{bench::MetricFamily::kCost, "cost"}}) {
    if (const std::optional<double> step = bench::visible_step(history, changes, family))
      text += fmt::format("{}{:.0f} % in {}", text.empty() ? "" : " and ", 100.0 * *step, name);
  }
  const std::string commits = counted(history.commits.size(), "commit");
  if (text.empty()) return commits + ": no metric has two values, no step can be seen.";
  return fmt::format("{}: steps of more than {} could be seen, smaller ones not{}.", commits, text,
                     history.commits.size() < kConfirmable ? ", and few can be confirmed yet" : "");
}

}  // namespace

std::string headline(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  const std::vector<ShiftGroup> open = grouped_shifts(history, changes, bench::ChangeState::kOpen);
  std::string text = open.empty() ? "No open regressions." : counted(open.size(), "open regression");
  if (!open.empty()) {
    const bench::LevelShift& first = *open.front().shifts.front();
    text += fmt::format(", first {} of {}: {}{}.", clean_line(open.front().metric),
                        subject_label(history.series[first.series].subject), change_label(first),
                        first.change ? ", " + interval_label(first) : "");
  }
  const std::vector<bench::SuspectedChange> suspected = bench::suspected_changes(history, changes);
  const auto worse = std::ranges::count_if(suspected, &bench::SuspectedChange::worse);
  if (!suspected.empty())
    text += fmt::format(" {} of the newest commits, {} for the worse, not confirmed.",
                        counted(suspected.size(), "suspected change"), worse);
  const auto drifting = std::ranges::count_if(changes.drifts, &bench::MetricDrift::is_open);
  if (drifting > 0)
    text += fmt::format(" {} drifting for the worse over commits.",
                        counted(static_cast<std::size_t>(drifting), "metric"));
  return text + " " + visible_sentence(history, changes);
}

std::string badge_svg(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  const std::size_t open = grouped_shifts(history, changes, bench::ChangeState::kOpen).size();
  const bool has_suspected =
      std::ranges::any_of(bench::suspected_changes(history, changes), &bench::SuspectedChange::worse);
  const std::string state = open > 0 ? counted(open, "open regression")
                                     : (has_findings(history, changes) ? "drifting"
                                        : has_suspected                ? "suspected changes"
                                                                       : "no open regressions");
  const char* color = open > 0 ? "#b3261e" : state == "no open regressions" ? "#1b6e33" : "#8a5200";
  const std::size_t width = 96 + 7 * state.size();
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"20\" role=\"img\" "
      "aria-label=\"benchmarks: {1}\"><rect width=\"84\" height=\"20\" fill=\"#40464d\"/>"
      "<rect x=\"84\" width=\"{2}\" height=\"20\" fill=\"{3}\"/>"
      "<g fill=\"#fff\" font-family=\"system-ui, sans-serif\" font-size=\"11\"><text x=\"8\" y=\"14\">"
      "benchmarks</text><text x=\"90\" y=\"14\">{1}</text></g></svg>\n",
      width, state, width - 84, color);
}

}  // namespace stillpoint::report
