// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats ablation`.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/cli/command_line.h"
#include "bench/cli/stats/stats_actions.h"
#include "bench/plan/bench_plan.h"
#include "core/base/counted.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

std::vector<std::string> variants_of(const std::vector<StoredRun>& runs) {
  std::vector<std::string> variants;
  for (const StoredRun& run : runs) {
    const std::string& variant = run.identity.variant;
    if (std::find(variants.begin(), variants.end(), variant) == variants.end()) variants.push_back(variant);
  }
  return variants;
}

/// Runs that may be pooled, and the bases of their variants.
struct Ablation {
  std::vector<StoredRun> runs;
  std::vector<AblationGroup> bases;
};

/// A plan that names a base, and its runs with any build.
struct BasedPlan {
  std::string base;
  std::set<std::int64_t> runs;  ///< ids
};

std::vector<BasedPlan> plans_with_base(const Store& store, const StatsArguments& arguments) {
  std::vector<BasedPlan> plans;
  for (const StoredPlan& plan : store.plans()) {
    const std::optional<std::string> base = ablation_base_of(plan);
    if (!base || (!arguments.plan.empty() && plan.name != arguments.plan)) continue;
    plans.push_back({.base = *base, .runs = {}});
    for (const StoredRun& run : runs_of_plan(store, plan.name)) plans.back().runs.insert(run.id);
  }
  return plans;
}

/// An ablation with the named base.
std::vector<Ablation> ablation_of_base(const RunGroup& group, const std::string& base) {
  std::vector<std::string> variants = variants_of(group.runs);
  if (std::erase(variants, base) == 0 || variants.empty()) return {};
  return {{group.runs, {{.base = base, .variants = variants}}}};
}

/// One ablation for each plan.
std::vector<Ablation> ablations_of_plans(const RunGroup& group, const std::vector<BasedPlan>& plans) {
  std::vector<Ablation> ablations;
  for (const BasedPlan& plan : plans) {
    std::vector<StoredRun> runs = group.runs;
    std::erase_if(runs, [&](const StoredRun& run) { return !plan.runs.contains(run.id); });
    std::vector<AblationGroup> bases = ablation_groups(plan.base, variants_of(runs));
    if (!bases.empty()) ablations.push_back({std::move(runs), std::move(bases)});
  }
  return ablations;
}

std::string change_text(const eval::RelativeChange& change) {
  const std::string interval =
      change.interval
          ? fmt::format("{:+.1f} to {:+.1f} %", 100.0 * change.interval->low, 100.0 * change.interval->high)
          : "no interval";
  return fmt::format("{:+.1f} % (n = {}, {})", 100.0 * change.median, change.count, interval);
}

/// Whether a row over all sequences has the pairs of the only one as replicates.
bool is_of_one_sequence(const AblationRow& row) { return row.sequence.empty() && row.sequences == 1; }

std::vector<std::string> cells_of(const AblationRow& row, const std::string& base) {
  const std::size_t count = row.difference ? row.difference->count : 0;
  std::vector<std::string> cells = {base, row.variant, row.sequence.empty() ? "(all)" : row.sequence,
                                    fmt::format("{}", count), fmt::format("{}", row.newly_failed)};
  if (row.difference) {
    cells.insert(
        cells.end(),
        {number_cell(row.difference->median), interval_cell(row.difference->interval, count),
         fmt::format("{:+.2f}", row.difference->effect), row.change ? change_text(*row.change) : "n/a"});
  } else {
    cells.insert(cells.end(), 4, "n/a");
  }
  if (is_of_one_sequence(row)) cells.back() += "; pairs of one sequence";
  if (!row.doubt.empty()) cells.back() += "; " + row.doubt;
  return cells;
}

/// Columns of `values_of`.
std::vector<std::string> ablation_columns() {
  return {"base",
          "variant",
          "sequence",
          "metric",
          "unit",
          "n",
          "newly_failed",
          "newly_without_value",
          "copies",
          "difference",
          "difference_low",
          "difference_high",
          "p",
          "effect",
          "relative_n",
          "relative_change",
          "relative_low",
          "relative_high",
          "relative_p",
          "doubt"};
}

/// Difference and interval in the unit of the metric; the relative change is head / base - 1.
report::DataRow values_of(const AblationRow& row, const std::string& base,
                          const report::DataRow& metric_and_unit) {
  report::DataRow values = {base, row.variant, row.sequence.empty() ? "(all)" : row.sequence};
  const auto add = [&values](const report::DataRow& more) {
    values.insert(values.end(), more.begin(), more.end());
  };
  add(metric_and_unit);
  add({report::data_value(row.difference ? row.difference->count : 0), report::data_value(row.newly_failed),
       report::data_value(row.newly_without_value), report::data_value(row.copies)});
  if (row.difference) {
    add({row.difference->median});
    add(interval_values(row.difference->interval));
    add({row.difference->p_value, row.difference->effect});
  } else {
    values.resize(values.size() + 5);
  }
  if (row.change) {
    add({report::data_value(row.change->count), row.change->median});
    add(interval_values(row.change->interval));
    add({row.change->p_value});
  } else {
    values.resize(values.size() + 5);
  }
  add({report::data_value(row.doubt)});
  return values;
}

/// The rows of one group, and n of each row.
struct AblationTable {
  GroupRows rows;
  std::set<std::size_t> counts;
  std::size_t copies = 0;
  std::size_t without_value = 0;
  bool has_one_sequence = false;  ///< in a row over all
};

/// Ablations of one group of runs, as they are shown.
struct ShownAblations {
  const RunGroup& group;
  std::vector<Ablation> ablations;
  std::string metric;
  std::string unit;
};

AblationTable table_of(const ShownAblations& shown) {
  AblationTable table{.rows = {.group = &shown.group, .rows = {}, .data = {}}, .counts = {}};
  for (const Ablation& one : shown.ablations) {
    for (const AblationGroup& group : one.bases) {
      for (const AblationRow& row : ablation(one.runs, group.base, shown.metric)) {
        const auto& variants = group.variants;
        if (std::find(variants.begin(), variants.end(), row.variant) == variants.end()) continue;
        table.rows.rows.push_back(cells_of(row, group.base));
        table.rows.data.push_back(values_of(row, group.base, {shown.metric, report::data_value(shown.unit)}));
        table.copies += row.sequence.empty() ? row.copies : 0;
        table.without_value += row.sequence.empty() ? row.newly_without_value : 0;
        table.has_one_sequence |= is_of_one_sequence(row);
        table.counts.insert(row.difference ? row.difference->count : 0);
      }
    }
  }
  return table;
}

[[noreturn]] void reject_base(const RunSelection& selection, const StatsArguments& arguments) {
  std::vector<std::string> variants;
  for (const RunGroup& group : selection.groups) {
    for (const std::string& variant : variants_of(group.runs)) {
      if (std::find(variants.begin(), variants.end(), variant) == variants.end()) variants.push_back(variant);
    }
  }
  const bool is_known = std::find(variants.begin(), variants.end(), arguments.base) != variants.end();
  std::string problem = "is required: no plan of these runs has the key ablation_base";
  if (!arguments.base.empty())
    problem = is_known ? "no other variant was executed with the same build, machine and mode"
                       : "there is no run of variant \"" + arguments.base + "\"";
  throw InputError("--base", fmt::format("{}; existing variants: {}", problem, fmt::join(variants, ", ")));
}

}  // namespace

int stats_ablation(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  require_metric(selection, arguments.metric);
  const std::string unit = metric_unit(selection, arguments.metric);
  StatsTable output{.header = {"base", "variant", "sequence", "n", "newly failed", "difference",
                               "95 % interval", "effect", "change"},
                    .kind = "stats_ablation",
                    .columns = ablation_columns(),
                    .groups = {},
                    .notes = {},
                    .version = 2};
  std::set<std::size_t> counts;
  std::size_t copies = 0;
  std::size_t without_value = 0;
  bool has_one_sequence = false;
  const std::vector<BasedPlan> plans =
      arguments.base.empty() ? plans_with_base(store, arguments) : std::vector<BasedPlan>{};
  for (const RunGroup& group : selection.groups) {
    AblationTable table =
        table_of({.group = group,
                  .ablations = arguments.base.empty() ? ablations_of_plans(group, plans)
                                                      : ablation_of_base(group, arguments.base),
                  .metric = arguments.metric,
                  .unit = unit});
    counts.merge(table.counts);
    copies += table.copies;
    without_value += table.without_value;
    has_one_sequence |= table.has_one_sequence;
    if (!table.rows.rows.empty()) output.groups.push_back(std::move(table.rows));
  }
  if (output.groups.empty()) reject_base(selection, arguments);
  output.notes = {
      fmt::format(
          "{}; paired by sequence and seed, repetitions reduced to their median; n: pairs, of (all) with "
          "several sequences: sequences; difference and change: Hodges-Lehmann estimates; effect: "
          "matched-pairs rank-biserial correlation, 1 = all "
          "pairs increased.",
          arguments.metric),
      interval_note("exact Wilcoxon signed-rank test", counts)};
  if (has_one_sequence)
    output.notes.emplace_back(
        "(all) of one sequence is the row of that sequence: its interval is over its pairs, and no statement "
        "on other sequences.");
  if (copies > 0) output.notes.push_back(copies_note(copies, "pair"));
  if (without_value > 0)
    output.notes.push_back(without_value_note(counted(without_value, "pair") + ": only the base has one"));
  output.notes = with_left_out(std::move(output.notes), selection);
  print_stats(output, arguments);
  return kExitOk;
}

}  // namespace stillpoint::bench
