// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/summary.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reports/tables/run_cells.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMostNamed = 5;
constexpr const char* kMetric = "ate_rmse_m";

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string failure_sentence(const StoredRun& run) {
  std::string text =
      system_label(run.identity) + " on " + run.identity.sequence + ": " + outcome_name(run.outcome);
  return run.detail.empty() ? text + "." : text + ", " + run.detail + ".";
}

std::vector<std::string> sequences_of(std::span<const StoredRun> runs) {
  return distinct(runs, [](const RunIdentity& identity) { return identity.sequence; });
}

/// Label of the smallest median error on a sequence; empty if fewer than two labels have one.
std::string best_on(std::span<const StoredRun> runs, const std::vector<std::string>& labels,
                    const std::string& sequence) {
  std::string best;
  double smallest = 0.0;
  std::size_t rivals = 0;
  for (const std::string& label : labels) {
    const TableCell cell = metric_cell(runs_of(runs, label, sequence), kMetric);
    if (!cell.number) continue;
    if (rivals++ == 0 || *cell.number < smallest) {
      best = label;
      smallest = *cell.number;
    }
  }
  return rivals < 2 ? "" : best;
}

std::string change_text(const MetricChange& change) {
  return fmt::format("{} of {} by {:+.1f} % ({:+.1f} to {:+.1f} %)", change.metric, change.subject,
                     100.0 * change.change.median, 100.0 * change.change.interval.low,
                     100.0 * change.change.interval.high);
}

}  // namespace

std::vector<std::string> outcome_sentences(std::span<const StoredRun> runs) {
  if (runs.empty()) return {"There are no runs."};
  std::vector<const StoredRun*> failed;
  for (const StoredRun& run : runs) {
    if (run.outcome != Outcome::kOk) failed.push_back(&run);
  }
  std::string first = counted(runs.size(), "run") + " of " +
                      counted(distinct(runs, system_label).size(), "variant") + " on " +
                      counted(sequences_of(runs).size(), "sequence") + ": ";
  first += failed.empty() ? "all ended well." : counted(failed.size(), "run") + " did not end well.";
  std::vector<std::string> sentences = {first};
  for (std::size_t i = 0; i < std::min(failed.size(), kMostNamed); ++i)
    sentences.push_back(failure_sentence(*failed[i]));
  if (failed.size() > kMostNamed)
    sentences.push_back(
        fmt::format("{} more did not end well; the tables mark them.", failed.size() - kMostNamed));
  return sentences;
}

std::string best_sentence(std::span<const StoredRun> runs) {
  const std::vector<std::string> labels = distinct(runs, system_label);
  std::map<std::string, std::size_t> wins;
  std::size_t contests = 0;
  for (const std::string& sequence : sequences_of(runs)) {
    const std::string best = best_on(runs, labels, sequence);
    if (best.empty()) continue;
    ++contests;
    ++wins[best];
  }
  if (contests == 0) return "";
  std::size_t most = 0;
  for (const auto& [label, count] : wins) most = std::max(most, count);
  std::vector<std::string> winners;
  for (const std::string& label : labels) {
    if (wins.contains(label) && wins.at(label) == most) winners.push_back(label);
  }
  const char* verb = winners.size() == 1 ? "has" : "each have";
  return fmt::format("{} {} the smallest trajectory error on {} of {} sequences.", fmt::join(winners, ", "),
                     verb, most, contests);
}

std::vector<std::string> change_sentences(const std::string& base, const Comparison& comparison) {
  std::vector<std::string> sentences = {fmt::format(
      "Against build {}: {} ({} pairs of runs, {} with bit-equal trajectories, {} newly lost, {} newly won).",
      base, verdict_name(comparison.verdict()), comparison.pairs, comparison.bit_equal, comparison.newly_lost,
      comparison.newly_won)};
  for (const ChangeVerdict verdict : {ChangeVerdict::kWorse, ChangeVerdict::kBetter}) {
    std::size_t named = 0;
    for (const MetricChange& change : comparison.changes) {
      if (change.verdict != verdict || named++ >= kMostNamed) continue;
      sentences.push_back((verdict == ChangeVerdict::kWorse ? "Worse: " : "Better: ") + change_text(change) +
                          ".");
    }
  }
  return sentences;
}

}  // namespace stillpoint
