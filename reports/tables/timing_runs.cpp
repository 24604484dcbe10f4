// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/timing_runs.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reports/tables/run_cells.h"

namespace stillpoint::report {
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
