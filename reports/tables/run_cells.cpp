// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/run_cells.h"

#include <algorithm>

#include <fmt/format.h>

namespace stillpoint {
namespace {

/// "2 of 3 runs did not end well: crashed (ended by signal 11)".
std::string failure_note(std::size_t failed, std::size_t all, const StoredRun& first) {
  std::string note =
      fmt::format("{} of {} runs did not end well: {}", failed, all, outcome_name(first.outcome));
  if (!first.detail.empty()) note += " (" + first.detail + ")";
  return note;
}

}  // namespace

std::string system_label(const RunIdentity& identity) {
  if (identity.system == "stillpoint") return identity.variant;
  return identity.variant.empty() ? identity.system : identity.system + " " + identity.variant;
}

std::vector<std::string> distinct(std::span<const StoredRun> runs,
                                  const std::function<std::string(const RunIdentity&)>& name) {
  std::vector<std::string> names;
  for (const StoredRun& run : runs) {
    const std::string value = name(run.identity);
    if (std::find(names.begin(), names.end(), value) == names.end()) names.push_back(value);
  }
  return names;
}

TableCell run_cell(const std::vector<const StoredRun*>& runs, const RunNumber& number) {
  TableCell cell;
  std::vector<double> values;
  std::size_t failed = 0;
  for (const StoredRun* run : runs) {
    cell.run_keys.push_back(run->key);
    const std::optional<double> value = run->outcome == Outcome::kOk ? number(*run) : std::nullopt;
    if (value) values.push_back(*value);
    failed += run->outcome == Outcome::kOk ? 0 : 1;
  }
  if (failed > 0) {
    const auto first = std::find_if(runs.begin(), runs.end(),
                                    [](const StoredRun* run) { return run->outcome != Outcome::kOk; });
    cell.note = failure_note(failed, runs.size(), **first);
  }
  const std::optional<Spread> summary = spread(values);
  if (summary) {
    cell.number = summary->median;
    cell.count = summary->count;
    if (summary->count > 1) cell.interval = summary->median_interval;  // one run does not say how others are
    cell.state = failed > 0 ? CellState::kPartial : CellState::kOk;
  } else {
    cell.state = failed > 0 ? CellState::kFailed : CellState::kEmpty;
  }
  return cell;
}

TableCell metric_cell(const std::vector<const StoredRun*>& runs, const std::string& metric) {
  TableCell cell = run_cell(runs, [&](const StoredRun& run) { return metric_value(run, metric); });
  for (const StoredRun* run : runs) {
    for (const Metric& candidate : run->metrics) {
      if (candidate.name == metric && cell.recipe.empty()) cell.recipe = candidate.recipe;
    }
  }
  return cell;
}

TableCell cost_cell(const std::vector<const StoredRun*>& runs, const std::string& module) {
  return run_cell(runs, [&](const StoredRun& run) -> std::optional<double> {
    for (const ModuleCost& cost : run.costs) {
      if (cost.module == module) return cost.mean_ms;
    }
    return std::nullopt;
  });
}

std::vector<const StoredRun*> runs_of(std::span<const StoredRun> runs, const std::string& label,
                                      const std::string& sequence) {
  std::vector<const StoredRun*> found;
  for (const StoredRun& run : runs) {
    const bool is_on_it = sequence.empty() || run.identity.sequence == sequence;
    if (is_on_it && run.identity.axis.empty() && system_label(run.identity) == label) found.push_back(&run);
  }
  return found;
}

bool tells_times(std::span<const StoredRun> runs, const StoredRun& run) {
  const auto is_timed = [](const StoredRun& other) { return other.identity.kind == "timing"; };
  const std::string label = system_label(run.identity);
  return is_timed(run) || std::none_of(runs.begin(), runs.end(), [&](const StoredRun& other) {
           return is_timed(other) && system_label(other.identity) == label;
         });
}

std::vector<const StoredRun*> timed_runs_of(std::span<const StoredRun> runs, const std::string& label) {
  std::vector<const StoredRun*> found = runs_of(runs, label, "");
  std::erase_if(found, [&](const StoredRun* run) { return !tells_times(runs, *run); });
  return found;
}

}  // namespace stillpoint
