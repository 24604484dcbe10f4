// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/summary.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/model/metrics.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

constexpr std::size_t kMaxListed = 5;

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string failure_sentence(const bench::StoredRun& run) {
  std::string text =
      system_label(run.identity) + " on " + run.identity.sequence + ": " + bench::outcome_name(run.outcome);
  return run.detail.empty() ? text + "." : text + ", " + run.detail + ".";
}

std::vector<std::string> sequences_of(std::span<const bench::StoredRun> runs) {
  return distinct(runs, [](const bench::RunIdentity& identity) { return identity.sequence; });
}

/// Label with the smallest median error on a sequence; empty if fewer than two labels have one.
std::string best_on(std::span<const bench::StoredRun> runs, const std::vector<std::string>& labels,
                    const std::string& sequence) {
  std::string best;
  double smallest = 0.0;
  std::size_t candidates = 0;
  for (const std::string& label : labels) {
    const TableCell cell = metric_cell(runs_of(runs, label, sequence), bench::headline_metric().id);
    if (!cell.number) continue;
    if (candidates++ == 0 || *cell.number < smallest) {
      best = label;
      smallest = *cell.number;
    }
  }
  return candidates < 2 ? "" : best;
}

std::string change_text(const bench::MetricChange& change) {
  return fmt::format("{} of {} by {:+.1f} % ({:+.1f} to {:+.1f} %)", change.metric, change.subject,
                     100.0 * change.change.median, 100.0 * change.change.interval.low,
                     100.0 * change.change.interval.high);
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
  std::size_t compared = 0;
  for (const std::string& sequence : sequences_of(runs)) {
    const std::string best = best_on(runs, labels, sequence);
    if (best.empty()) continue;
    ++compared;
    ++wins[best];
  }
  if (compared == 0) return "";
  std::size_t most = 0;
  for (const auto& [label, count] : wins) most = std::max(most, count);
  std::vector<std::string> winners;
  for (const std::string& label : labels) {
    if (wins.contains(label) && wins.at(label) == most) winners.push_back(label);
  }
  const char* verb = winners.size() == 1 ? "has" : "each have";
  return fmt::format("{} {} the smallest {} on {} of {} sequences.", fmt::join(winners, ", "), verb,
                     bench::headline_metric().label, most, compared);
}

std::vector<std::string> change_sentences(const std::string& base, const bench::Comparison& comparison) {
  std::vector<std::string> sentences = {
      fmt::format("Compared with build {}: {} ({} pairs of runs, {} with bit-equal trajectories, {} newly "
                  "failed, {} newly succeeded).",
                  base, change_class_name(comparison.result()), comparison.pairs, comparison.bit_equal,
                  comparison.newly_failed, comparison.newly_succeeded)};
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
