// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include <fmt/format.h>

#include "bench/cli/analysis/stats_ablation.h"
#include "bench/cli/analysis/stats_faults.h"
#include "bench/cli/analysis/stats_repeat.h"
#include "bench/cli/analysis/stats_table.h"
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr const char* kMedianTest = "exact, by order statistics";

std::size_t count_of(const RunSpread& row) { return row.spread ? row.spread->count : 0; }

std::vector<std::string> summary_cells(const RunSpread& row) {
  const std::size_t count = count_of(row);
  std::vector<std::string> cells = {row.sequence,
                                    row.variant,
                                    row.axis.empty() ? "" : fmt::format("{} = {}", row.axis, row.axis_value),
                                    fmt::format("{}", row.runs),
                                    fmt::format("{}", row.failed),
                                    fmt::format("{}", count)};
  if (!row.spread) {
    cells.insert(cells.end(), 4, "n/a");
    return cells;
  }
  cells.insert(cells.end(),
               {number_cell(row.spread->median), interval_cell(row.spread->median_interval, count),
                interval_cell(row.spread->quartiles, count), number_cell(row.spread->worst)});
  return cells;
}

/// Rows of the spreads of one metric, and the numbers of replicates behind them.
struct SpreadRows {
  std::vector<GroupRows> groups;
  std::set<std::size_t> counts;
};

/// One row for each spread that satisfies `keep`; a group without a row is left out.
SpreadRows spread_rows(const RunSelection& selection, const std::string& metric,
                       bool (*keep)(const RunSpread&), std::vector<std::string> (*cells)(const RunSpread&)) {
  require_metric(selection, metric);
  SpreadRows result;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}};
    for (const RunSpread& row : run_spreads(group.runs, metric)) {
      if (!keep(row)) continue;
      result.counts.insert(count_of(row));
      rows.rows.push_back(cells(row));
    }
    if (!rows.rows.empty()) result.groups.push_back(std::move(rows));
  }
  return result;
}

int summary(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  const SpreadRows rows = spread_rows(
      selection, arguments.metric, [](const RunSpread&) { return true; }, summary_cells);
  print_groups(
      {"sequence", "variant", "sweep", "runs", "failed", "n", "median", "median 95 %", "quartiles", "worst"},
      rows.groups,
      with_left_out(
          {arguments.metric + "; n: replicates with a value.", interval_note(kMedianTest, rows.counts)},
          selection),
      arguments);
  return kExitOk;
}

std::vector<std::string> sweep_cells(const RunSpread& row) {
  const auto cell = [](const std::optional<double>& value) { return value ? number_cell(*value) : "n/a"; };
  const eval::Spread spread = row.spread.value_or(eval::Spread{});
  const std::optional<eval::Interval>& interval = spread.median_interval;
  return {row.axis,
          fmt::format("{}", row.axis_value),
          row.sequence,
          row.variant,
          fmt::format("{}", row.runs),
          fmt::format("{}", row.failed),
          fmt::format("{}", spread.count),
          cell(row.spread ? std::optional(spread.median) : std::nullopt),
          cell(interval ? std::optional(interval->low) : std::nullopt),
          cell(interval ? std::optional(interval->high) : std::nullopt)};
}

int sweep(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  const SpreadRows rows = spread_rows(
      selection, arguments.metric, [](const RunSpread& row) { return !row.axis.empty(); }, sweep_cells);
  if (rows.groups.empty())
    throw InputError(arguments.store, "contains no run of a sweep; add a [sweep] to a plan");
  print_groups(
      {"axis", "value", "sequence", "variant", "runs", "failed", "n", "median", "median 95 % low", "high"},
      rows.groups,
      with_left_out({arguments.metric + ".", interval_note(kMedianTest, rows.counts)}, selection), arguments);
  return kExitOk;
}

/// Adds the action and the options that all subcommands have.
Command subcommand(Command command, const std::shared_ptr<StatsArguments>& arguments,
                   int (*action)(const StatsArguments&)) {
  command.options.insert(command.options.begin(),
                         {{"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store},
                          {"--plan", "Only the runs of this plan", &arguments->plan},
                          {"--build", "Build, a prefix of one, or \"all\" [the newest]", &arguments->build},
                          {"--csv", "CSV instead of Markdown", &arguments->csv}});
  command.action = [arguments, action] { return action(*arguments); };
  return command;
}

}  // namespace

Command stats_command() {
  const auto arguments = std::make_shared<StatsArguments>();
  arguments->metric = headline_metric().id;
  const Option metric{"--metric", "Metric to evaluate [" + arguments->metric + "]", &arguments->metric};
  const Option base{"--base", "Variant that the others are compared with [ablation_base of the plan]",
                    &arguments->base};
  return {
      .name = "stats",
      .summary = "Statistics over the runs of a store",
      .example = "stats ablation --plan table2_ablation_synthetic",
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
                      .example = "stats ablation --plan table2_ablation_synthetic",
                      .options = {metric, base}},
                     arguments, stats_ablation),
          subcommand({.name = "faults",
                      .summary = "Matrix of sensor faults and variants: outcome, error after recovery and "
                                 "false confidence",
                      .example = "stats faults --plan faults"},
                     arguments, stats_faults),
          subcommand({.name = "repeat",
                      .summary = "Check that repetitions, or runs of two machines, are bit-equal",
                      .example = "stats repeat --store build/bench/store.sqlite",
                      .options = {{"--with", "Store of another machine: compare the runs that both contain",
                                   &arguments->other}}},
                     arguments, stats_repeat),
          subcommand({.name = "sweep",
                      .summary = "Degradation curves: one row per value, sequence and variant",
                      .example = "stats sweep --plan sweep_synthetic --csv",
                      .options = {metric}},
                     arguments, sweep)}};
}

}  // namespace stillpoint::bench
