// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats`: the subcommands and their options.
#include <memory>
#include <utility>

#include "bench/cli/command_line.h"
#include "bench/cli/stats/stats_actions.h"
#include "bench/model/metrics.h"

namespace stillpoint::bench {
namespace {

/// Adds the action and the options that all subcommands have.
Command subcommand(Command command, const std::shared_ptr<StatsArguments>& arguments,
                   int (*action)(const StatsArguments&)) {
  command.options.insert(command.options.begin(),
                         {store_option(&arguments->store),
                          {"--plan", "Only the runs of this plan", &arguments->plan},
                          {"--build", "Build, a prefix of one, or \"all\" [the newest]", &arguments->build},
                          {"--format",
                           "table (Markdown), csv or json; the latter with all digits, see bench/README.md "
                           "[table]",
                           &arguments->format_name}});
  command.action = [arguments, action] {
    arguments->format = enum_of<StatsFormat>("--format", arguments->format_name);
    return action(*arguments);
  };
  return command;
}

}  // namespace

Command stats_command() {
  const auto arguments = std::make_shared<StatsArguments>();
  arguments->metric = headline_metric().id;
  const Option metric{"--metric", "Metric to evaluate [" + arguments->metric + "]", &arguments->metric};
  const Option base{"--base", "Variant that the others are compared with [ablation_base of the plan]",
                    &arguments->base};
  std::vector<Command> subcommands = {
      subcommand({.name = "summary",
                  .summary = "Median with confidence interval, quartiles, worst value and failures "
                             "of each variant on each sequence",
                  .example = "stats summary --plan quick --metric " + arguments->metric,
                  .options = {metric}},
                 arguments, stats_summary),
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
      subcommand({.name = "imperfections",
                  .summary = "Geometric means of the ATE over sequences with injected faults, lost runs "
                             "and false confidence",
                  .example = "stats imperfections --plan imperfections"},
                 arguments, stats_imperfections),
      subcommand({.name = "repeat",
                  .summary = "Check that repetitions, or runs of two machines, are bit-equal",
                  .example = "stats repeat build/bench/store.sqlite",
                  .options = {{"--with", "Store of another machine: compare the runs that both contain",
                               &arguments->other}}},
                 arguments, stats_repeat),
      subcommand({.name = "sweep",
                  .summary = "Degradation curves: one row per value, sequence and variant",
                  .example = "stats sweep --plan sweep_synthetic --format csv",
                  .options = {metric}},
                 arguments, stats_sweep)};
  return {.name = "stats",
          .summary = "Statistics over the runs of a store; without a subcommand: summary",
          .example = "stats build/bench/store.sqlite",
          .options = subcommands.front().options,
          .action = subcommands.front().action,
          .subcommands = std::move(subcommands)};
}

}  // namespace stillpoint::bench
