// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/run_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/analysis/run_statistics.h"
#include "bench/model/metrics.h"

namespace stillpoint::report {
namespace {

/// "2 of 3 runs failed: crashed (ended by signal 11)".
std::string failure_note(std::size_t failed, std::size_t all, const bench::StoredRun& first) {
  std::string note = fmt::format("{} of {} runs failed: {}", failed, all, bench::outcome_name(first.outcome));
  if (!first.detail.empty()) note += " (" + first.detail + ")";
  return note;
}

/// "1 of 3 runs has an infinite value"; empty if all are finite.
std::string infinite_note(const std::vector<const bench::StoredRun*>& runs, std::string_view metric) {
  const auto count = std::count_if(runs.begin(), runs.end(), [&](const bench::StoredRun* run) {
    const std::optional<double> value = bench::metric_value(*run, metric);
    return run->outcome == bench::Outcome::kOk && value && !std::isfinite(*value);
  });
  return count == 0 ? ""
                    : fmt::format("{} of {} runs {} an infinite value, which is excluded", count, runs.size(),
                                  count == 1 ? "has" : "have");
}

/// A number of a run; nullopt if it has none.
using RunNumber = std::function<std::optional<double>(const bench::StoredRun&)>;

/// Median over the successful runs, with a note about the failed ones.
/// @param runs repetitions of one benchmark case; an empty list gives an empty cell
TableCell run_cell(const std::vector<const bench::StoredRun*>& runs, const RunNumber& number) {
  TableCell cell;
  std::vector<double> values;
  std::size_t failed = 0;
  for (const bench::StoredRun* run : runs) {
    cell.run_keys.push_back(run->key);
    const std::optional<double> value = run->outcome == bench::Outcome::kOk ? number(*run) : std::nullopt;
    if (value) values.push_back(*value);
    failed += run->outcome == bench::Outcome::kOk ? 0 : 1;
  }
  if (failed > 0) {
    const auto first = std::find_if(runs.begin(), runs.end(), [](const bench::StoredRun* run) {
      return run->outcome != bench::Outcome::kOk;
    });
    cell.note = failure_note(failed, runs.size(), **first);
  }
  const std::optional<eval::Spread> summary = eval::spread(values);
  if (summary) {
    cell.number = summary->median;
    cell.count = summary->count;
    cell.interval = summary->median_interval;
    cell.state = failed > 0 ? CellState::kPartial : CellState::kOk;
  } else {
    cell.state = failed > 0 ? CellState::kFailed : CellState::kEmpty;
  }
  return cell;
}

/// `run_cell` over the mean time of a module.
TableCell cost_cell(const std::vector<const bench::StoredRun*>& runs, const std::string& module) {
  return run_cell(runs, [&](const bench::StoredRun& run) -> std::optional<double> {
    for (const bench::ModuleCost& cost : run.costs) {
      if (cost.module == module) return cost.mean_ms;
    }
    return std::nullopt;
  });
}

}  // namespace

std::string system_label(const bench::RunIdentity& identity) {
  // The variants of another system begin with its name.
  if (identity.system == "stillpoint" || identity.variant.starts_with(identity.system))
    return identity.variant;
  return identity.variant.empty() ? identity.system : identity.system + " " + identity.variant;
}

std::vector<std::string> distinct(std::span<const bench::StoredRun> runs,
                                  const std::function<std::string(const bench::RunIdentity&)>& name) {
  std::vector<std::string> names;
  for (const bench::StoredRun& run : runs) {
    const std::string value = name(run.identity);
    if (std::find(names.begin(), names.end(), value) == names.end()) names.push_back(value);
  }
  return names;
}

std::vector<std::string> sequences_of(std::span<const bench::StoredRun> runs) {
  return distinct(runs, [](const bench::RunIdentity& identity) { return identity.sequence; });
}

TableCell with_note(TableCell cell, const std::string& note) {
  if (!note.empty()) cell.note += (cell.note.empty() ? "" : "; ") + note;
  return cell;
}

TableCell metric_cell(const std::vector<const bench::StoredRun*>& runs, std::string_view metric) {
  TableCell cell = run_cell(runs, [&](const bench::StoredRun& run) {
    const std::optional<double> value = bench::metric_value(run, metric);
    return value && std::isfinite(*value) ? value : std::nullopt;
  });
  if (const std::optional<eval::Spread> spread = bench::metric_spread(runs, std::string(metric))) {
    cell.number = spread->median;
    cell.count = spread->count;
    cell.interval = spread->median_interval;
    cell.modes = spread->modes;
    if (spread->count > 1) cell.worst = spread->worst;
  }
  cell = with_note(std::move(cell), bench::scatter_note(runs, metric));
  cell = with_note(std::move(cell), infinite_note(runs, metric));
  for (const bench::StoredRun* run : runs) {
    for (const bench::Metric& candidate : run->metrics) {
      if (candidate.name == metric && cell.protocol.empty()) cell.protocol = candidate.protocol;
    }
  }
  cell = with_note(std::move(cell), bench::protocol_difference_note(runs, metric));
  if (const std::string few = bench::few_rpe_pairs_note(runs, metric); !few.empty()) {
    cell = with_note(std::move(cell), few);
    cell.is_suspicious = true;
  }
  const bench::MetricDescriptor* descriptor = bench::find_metric(metric);
  const bool is_accuracy =
      descriptor != nullptr && descriptor->source == bench::MetricSource::kTrajectory && cell.number;
  if (!is_accuracy) return cell;
  if (const auto coverage = bench::metric_spread(runs, std::string(bench::metric_id::kCoverage)))
    cell.coverage = coverage->median;
  cell = with_note(std::move(cell), bench::doubtful_error_note(runs, metric));
  return with_note(std::move(cell), bench::missing_boxes_note(runs));
}

TableCell mean_cell(std::span<const TableCell> cells) {
  TableCell mean{.number = 0.0, .state = CellState::kOk};
  for (const TableCell& cell : cells) {
    if (!cell.number) return {};
    *mean.number += *cell.number / static_cast<double>(cells.size());
    mean.is_suspicious = mean.is_suspicious || cell.is_suspicious;
    if (mean.note.empty()) mean.note = cell.note;
  }
  return cells.empty() ? TableCell{} : mean;
}

std::vector<const bench::StoredRun*> runs_of(std::span<const bench::StoredRun> runs, const std::string& label,
                                             const std::string& sequence) {
  std::vector<const bench::StoredRun*> found;
  for (const bench::StoredRun& run : runs) {
    const bool matches_sequence = sequence.empty() || run.identity.sequence == sequence;
    if (matches_sequence && run.identity.axis.empty() && system_label(run.identity) == label)
      found.push_back(&run);
  }
  return found;
}

namespace {

using bench::TimeSource;

TimeSource best_source(const std::vector<const bench::StoredRun*>& runs) {
  TimeSource best = TimeSource::kShared;
  for (const bench::StoredRun* run : runs) {
    if (run->outcome == bench::Outcome::kOk) best = std::min(best, bench::time_source(*run));
  }
  return best;
}

/// A failed timing run is counted with the successful ones, whatever the load was.
bool belongs_to(const bench::StoredRun& run, TimeSource source) {
  if (source == TimeSource::kShared) return true;
  const TimeSource own = bench::time_source(run);
  return run.outcome == bench::Outcome::kOk ? own == source : own != TimeSource::kShared;
}

std::vector<const bench::StoredRun*> runs_with_label(std::span<const bench::StoredRun> runs,
                                                     const std::string& label) {
  std::vector<const bench::StoredRun*> found;
  for (const bench::StoredRun& run : runs) {
    if (system_label(run.identity) == label) found.push_back(&run);
  }
  return found;
}

}  // namespace

TimedRuns timed_runs(const std::vector<const bench::StoredRun*>& runs) {
  TimedRuns timed{.runs = runs, .source = best_source(runs)};
  std::erase_if(timed.runs, [&](const bench::StoredRun* run) { return !belongs_to(*run, timed.source); });
  return timed;
}

TimedRuns timed_runs_of(std::span<const bench::StoredRun> runs, const std::string& label) {
  return timed_runs(runs_of(runs, label, ""));
}

TableCell time_cell(const TimedRuns& timed, const std::string& module) {
  TableCell cell = cost_cell(timed.runs, module);
  return cell.number ? with_note(std::move(cell), bench::time_source_note(timed.source)) : cell;
}

TableCell undisturbed_time_cell(const TimedRuns& timed, const std::string& module) {
  TableCell cell = cost_cell(timed.runs, module);
  if (!cell.number || timed.source == TimeSource::kUndisturbed) return cell;
  const char* found = timed.source == TimeSource::kBusy ? "the timing runs of the store shared the machine"
                                                        : "the store has no successful timing run of it";
  return {.note = fmt::format(
              "no time is shown: {}; execute a plan with kind = \"timing\", e.g. `stillpoint bench "
              "table3_runtime`, into a new store while the machine is idle",
              found)};
}

bool has_shown_times(std::span<const bench::StoredRun> runs, const bench::StoredRun& run) {
  return belongs_to(run, best_source(runs_with_label(runs, system_label(run.identity))));
}

std::vector<std::string> time_source_sentences(std::span<const bench::StoredRun> runs) {
  std::vector<bench::StoredRun> with_times(runs.begin(), runs.end());
  std::erase_if(with_times, [](const bench::StoredRun& run) { return run.costs.empty(); });
  std::map<TimeSource, std::vector<std::string>> labels;
  for (const std::string& label : distinct(with_times, system_label))
    labels[best_source(runs_with_label(runs, label))].push_back(label);
  std::vector<std::string> sentences;
  for (const auto& [source, names] : labels) {
    if (const std::string note = bench::time_source_note(source); !note.empty())
      sentences.push_back(fmt::format("{}: {}.", fmt::join(names, ", "), note));
  }
  return sentences;
}

}  // namespace stillpoint::report
