// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/analysis/run_statistics.h"
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"
#include "reports/tables/text_table.h"

namespace stillpoint::bench {
namespace {

struct StatsArguments {
  std::string store = "build/bench/store.sqlite";
  std::string plan;
  std::string metric{headline_metric().id};
  std::string base = "stillpoint";
  bool csv = false;
};

std::vector<StoredRun> runs_of(const Store& store, const StatsArguments& arguments) {
  std::vector<StoredRun> runs = arguments.plan.empty() ? store.runs() : store.plan_runs(arguments.plan);
  if (runs.empty())
    throw InputError(arguments.store, "contains no completed run; execute some with `stillpoint bench`");
  return runs;
}

void print(const report::TableRows& rows, const StatsArguments& arguments) {
  std::cout << report::format_table(rows,
                                    arguments.csv ? report::TableStyle::kCsv : report::TableStyle::kMarkdown);
}

std::string number(double value) { return fmt::format("{:.5g}", value); }
std::string change_text(const eval::RelativeChange& change) {
  return fmt::format("{:+.1f} % ({:+.1f} to {:+.1f})", 100.0 * change.median, 100.0 * change.interval.low,
                     100.0 * change.interval.high);
}
std::string interval_text(const eval::Interval& interval) {
  return number(interval.low) + " to " + number(interval.high);
}

int summary(const StatsArguments& arguments) {
  const Store store(arguments.store);
  report::TableRows rows = {
      {"sequence", "variant", "sweep", "runs", "failed", "median", "median 95 %", "quartiles", "worst"}};
  for (const RunSpread& row : run_spreads(runs_of(store, arguments), arguments.metric)) {
    std::vector<std::string> cells = {
        row.sequence, row.variant, row.axis.empty() ? "" : fmt::format("{} = {}", row.axis, row.axis_value),
        fmt::format("{}", row.runs), fmt::format("{}", row.failed)};
    if (row.spread) {
      cells.insert(cells.end(), {number(row.spread->median), interval_text(row.spread->median_interval),
                                 interval_text(row.spread->quartiles), number(row.spread->worst)});
    } else {
      cells.insert(cells.end(), 4, "n/a");
    }
    rows.push_back(std::move(cells));
  }
  print(rows, arguments);
  return kExitOk;
}

int show_ablation(const StatsArguments& arguments) {
  const Store store(arguments.store);
  report::TableRows rows = {
      {"variant", "sequence", "pairs", "newly failed", "difference", "95 % interval", "effect", "change"}};
  for (const AblationRow& row : ablation(runs_of(store, arguments), arguments.base, arguments.metric)) {
    std::vector<std::string> cells = {row.variant, row.sequence.empty() ? "(all)" : row.sequence};
    if (row.difference) {
      cells.insert(
          cells.end(),
          {fmt::format("{}", row.difference->count), fmt::format("{}", row.newly_failed),
           number(row.difference->median), interval_text(row.difference->interval),
           fmt::format("{:+.2f}", row.difference->effect), row.change ? change_text(*row.change) : "n/a"});
    } else {
      cells.insert(cells.end(), {"0", fmt::format("{}", row.newly_failed), "n/a", "n/a", "n/a", "n/a"});
    }
    rows.push_back(std::move(cells));
  }
  print(rows, arguments);
  if (!arguments.csv) {
    std::cout << "\nMedians of " << arguments.metric << " against " << arguments.base
              << ", paired by sequence and seed; effect: matched-pairs rank-biserial correlation, 1 = all "
                 "pairs increased.\n";
  }
  return kExitOk;
}

int repeat(const StatsArguments& arguments) {
  const Store store(arguments.store);
  report::TableRows rows = {{"run", "repetitions", "trajectories", "first difference"}};
  bool all_equal = true;
  for (const RepetitionRow& row : repetition_report(store, runs_of(store, arguments))) {
    all_equal = all_equal && row.distinct_trajectories == 1 && row.first_difference.empty();
    rows.push_back({row.label, fmt::format("{}", row.repetitions),
                    fmt::format("{}", row.distinct_trajectories),
                    row.first_difference.empty() ? (row.distinct_trajectories == 1 ? "none" : "not recorded")
                                                 : row.first_difference});
  }
  if (rows.size() == 1)
    throw InputError(arguments.store, "contains no repeated run; set `repetitions = 2` in a plan");
  print(rows, arguments);
  if (!arguments.csv) {
    std::cout << (all_equal ? "\nAll repetitions are bit-equal: a single run is sufficient.\n"
                            : "\nSome repetitions differ: evaluate the spread over repetitions.\n");
  }
  return all_equal ? kExitOk : kExitFindings;
}

int sweep(const StatsArguments& arguments) {
  const Store store(arguments.store);
  report::TableRows rows = {
      {"axis", "value", "sequence", "variant", "median", "low", "high", "runs", "failed"}};
  for (const RunSpread& row : run_spreads(runs_of(store, arguments), arguments.metric)) {
    if (row.axis.empty()) continue;
    const auto cell = [&](double value) { return row.spread ? number(value) : std::string("n/a"); };
    const eval::Spread spread = row.spread.value_or(eval::Spread{});
    rows.push_back({row.axis, fmt::format("{}", row.axis_value), row.sequence, row.variant,
                    cell(spread.median), cell(spread.median_interval.low), cell(spread.median_interval.high),
                    fmt::format("{}", row.runs), fmt::format("{}", row.failed)});
  }
  if (rows.size() == 1)
    throw InputError(arguments.store, "contains no run of a sweep; add a [sweep] to a plan");
  print(rows, arguments);
  return kExitOk;
}

/// Adds the action and the options that all subcommands have.
Command subcommand(Command command, const std::shared_ptr<StatsArguments>& arguments,
                   int (*action)(const StatsArguments&)) {
  command.options.insert(command.options.begin(),
                         {{"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store},
                          {"--plan", "Only the runs of this plan", &arguments->plan},
                          {"--csv", "CSV instead of Markdown", &arguments->csv}});
  command.action = [arguments, action] { return action(*arguments); };
  return command;
}

}  // namespace

Command stats_command() {
  const auto arguments = std::make_shared<StatsArguments>();
  const Option metric{"--metric", "Metric to evaluate [" + arguments->metric + "]", &arguments->metric};
  const Option base{"--base", "Variant that the others are compared with [stillpoint]", &arguments->base};
  return {.name = "stats",
          .summary = "Statistics over the runs of a store",
          .example = "stats ablation --plan table2_ablation_synthetic --base dynamic_vins",
          .subcommands = {
              subcommand({.name = "summary",
                          .summary = "Median with confidence interval, quartiles, worst value and failures "
                                     "of each variant on each sequence",
                          .example = "stats summary --plan quick --metric " + arguments->metric,
                          .options = {metric}},
                         arguments, summary),
              subcommand({.name = "ablation",
                          .summary = "Paired differences from a base variant, with confidence interval and "
                                     "effect size",
                          .example = "stats ablation --plan quick --base stillpoint",
                          .options = {metric, base}},
                         arguments, show_ablation),
              subcommand({.name = "repeat",
                          .summary = "Check that repetitions are bit-equal; if not, print the first frame "
                                     "and module that differ",
                          .example = "stats repeat --store build/bench/store.sqlite"},
                         arguments, repeat),
              subcommand({.name = "sweep",
                          .summary = "Degradation curves: one row per value, sequence and variant",
                          .example = "stats sweep --plan sweep_synthetic --csv",
                          .options = {metric}},
                         arguments, sweep)}};
}

}  // namespace stillpoint::bench
