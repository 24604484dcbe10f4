// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/summary.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/model/metrics.h"
#include "reports/page/html_parts.h"
#include "reports/tables/change_text.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

constexpr std::size_t kMaxListed = 5;

std::string failure_sentence(const bench::StoredRun& run) {
  std::string text =
      system_label(run.identity) + " on " + run.identity.sequence + ": " + bench::outcome_name(run.outcome);
  return run.detail.empty() ? text + "." : text + ", " + run.detail + ".";
}

/// Label with the smallest median error on a sequence.
struct BestLabel {
  std::string label;                ///< empty if fewer than two labels have an error
  std::vector<std::size_t> counts;  ///< number of runs behind each compared median
};

BestLabel best_on(std::span<const bench::StoredRun> runs, const std::vector<std::string>& labels,
                  const std::string& sequence) {
  BestLabel best;
  double smallest = 0.0;
  for (const std::string& label : labels) {
    const TableCell cell = metric_cell(runs_of(runs, label, sequence), bench::headline_metric().id);
    if (!cell.number) continue;
    if (best.counts.empty() || *cell.number < smallest) {
      best.label = label;
      smallest = *cell.number;
    }
    best.counts.push_back(cell.count);
  }
  return best.counts.size() < 2 ? BestLabel{} : best;
}

std::string change_text(const bench::MetricChange& change) {
  return fmt::format("{} of {} by {} ({})", change.metric, change.subject, percent_text(change.change.median),
                     interval_text(change.change));
}

}  // namespace

std::vector<std::string> outcome_sentences(std::span<const bench::StoredRun> runs) {
  if (runs.empty()) return {"There are no runs."};
  std::vector<const bench::StoredRun*> failed;
  for (const bench::StoredRun& run : runs) {
    if (run.outcome != bench::Outcome::kOk) failed.push_back(&run);
  }
  std::string first = counted(runs.size(), "run") + " of " +
                      counted(distinct(runs, system_label).size(), "variant") + " on " +
                      counted(sequences_of(runs).size(), "sequence") + ": ";
  first += failed.empty() ? "all succeeded." : counted(failed.size(), "run") + " failed.";
  std::vector<std::string> sentences = {first};
  for (std::size_t i = 0; i < std::min(failed.size(), kMaxListed); ++i)
    sentences.push_back(failure_sentence(*failed[i]));
  if (failed.size() > kMaxListed)
    sentences.push_back(
        fmt::format("{} more failed; they are marked in the tables.", failed.size() - kMaxListed));
  return sentences;
}

std::string best_sentence(std::span<const bench::StoredRun> runs) {
  const std::vector<std::string> labels = distinct(runs, system_label);
  std::map<std::string, std::size_t> wins;
  std::vector<std::size_t> counts;
  std::size_t compared = 0;
  for (const std::string& sequence : sequences_of(runs)) {
    const BestLabel best = best_on(runs, labels, sequence);
    if (best.label.empty()) continue;
    ++compared;
    ++wins[best.label];
    counts.insert(counts.end(), best.counts.begin(), best.counts.end());
  }
  if (compared == 0) return "";
  std::size_t most = 0;
  for (const auto& [label, count] : wins) most = std::max(most, count);
  std::vector<std::string> winners;
  for (const std::string& label : labels) {
    if (wins.contains(label) && wins.at(label) == most) winners.push_back(label);
  }
  const char* verb = winners.size() == 1 ? "has" : "each have";
  const auto [fewest, largest] = std::minmax_element(counts.begin(), counts.end());
  return fmt::format(
      "{} {} the smallest median {} on {} of {} sequences ({}; not a statement of significance).",
      fmt::join(winners, ", "), verb, bench::headline_metric().label, most, compared,
      count_text(*fewest, *largest));
}

std::vector<std::string> change_sentences(const std::string& base, const bench::Comparison& comparison) {
  std::vector<std::string> sentences = {fmt::format("Compared with build {}: {}; {}.", base,
                                                    change_class_name(comparison.result()),
                                                    count_sentence(comparison))};
  for (const bench::ChangeClass wanted : {bench::ChangeClass::kWorse, bench::ChangeClass::kBetter}) {
    std::size_t listed = 0;
    for (const bench::MetricChange& change : comparison.changes) {
      if (change.result != wanted || listed++ >= kMaxListed) continue;
      sentences.push_back((wanted == bench::ChangeClass::kWorse ? "Worse: " : "Better: ") +
                          change_text(change) + ".");
    }
  }
  return sentences;
}

}  // namespace stillpoint::report
