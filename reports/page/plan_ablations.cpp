// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/plan_ablations.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "bench/analysis/run_statistics.h"
#include "bench/plan/bench_plan.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

/// Runs of the system of the base in a plan, outside sweeps.
std::vector<bench::StoredRun> runs_of_system(const bench::StoredPlan& plan, const std::string& base,
                                             std::span<const bench::StoredRun> runs) {
  const std::set<std::string> keys(plan.run_keys.begin(), plan.run_keys.end());
  const auto of_base = std::ranges::find_if(runs, [&](const bench::StoredRun& run) {
    return run.identity.variant == base && keys.contains(run.key);
  });
  const std::string system = of_base == runs.end() ? "stillpoint" : of_base->identity.system;
  std::vector<bench::StoredRun> found;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(found), [&](const bench::StoredRun& run) {
    return run.identity.system == system && run.identity.axis.empty() && keys.contains(run.key);
  });
  return found;
}

std::vector<bench::StoredRun> runs_in(const std::vector<bench::StoredRun>& runs,
                                      const bench::AblationGroup& group) {
  std::vector<bench::StoredRun> found;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(found), [&](const bench::StoredRun& run) {
    const std::string& variant = run.identity.variant;
    return variant == group.base ||
           std::find(group.variants.begin(), group.variants.end(), variant) != group.variants.end();
  });
  return found;
}

std::string missing_reason(const std::vector<std::string>& variants, const std::string& base) {
  if (variants.empty()) return "it has no run of stillpoint outside sweeps";
  if (std::find(variants.begin(), variants.end(), base) == variants.end())
    return "its base " + base + " has no run on this page";
  return "only its base " + base + " was run";
}

}  // namespace

PlanAblations plan_ablations(std::span<const bench::StoredPlan> plans,
                             std::span<const bench::StoredRun> runs) {
  PlanAblations result;
  if (plans.empty())
    result.missing = {
        "There is no ablation, because the runs belong to no plan that names a base variant; "
        "`stillpoint stats ablation --base VARIANT` compares with any variant."};
  for (const bench::StoredPlan& plan : plans) {
    const std::string start = "Plan " + plan.name + " has no ablation: ";
    const std::optional<std::string> base = bench::ablation_base_of(plan);
    if (!base) {
      result.missing.push_back(start + "its stored text names no base variant (key ablation_base).");
      continue;
    }
    const std::vector<bench::StoredRun> own = runs_of_system(plan, *base, runs);
    const std::vector<std::string> variants = distinct(own, system_label);
    const std::vector<bench::AblationGroup> groups = bench::ablation_groups(*base, variants);
    if (groups.empty()) result.missing.push_back(start + missing_reason(variants, *base) + ".");
    for (const bench::AblationGroup& group : groups) {
      result.ablations.push_back({.plan = plan.name,
                                  .base = group.base,
                                  .is_base_of_plan = group.base == *base,
                                  .runs = runs_in(own, group)});
    }
  }
  return result;
}

namespace {

/// Color saturation [%]: 54, at which text still has a contrast of 4.5 in both themes, from a factor of two
/// on, in either direction.
int color_depth(double change) {
  const double octaves = std::log2(std::max(1.0 + change, 1e-3));
  return static_cast<int>(std::lround(54.0 * std::min(std::abs(octaves), 1.0)));
}

const char* direction_class(double change) {
  if (change == 0.0) return "equal";
  return change > 0.0 ? "worse" : "better";
}

/// Hatched unless the change is significant; neither better nor worse if it is not comparable.
std::string cell_class(const bench::AblationRow& row, double change, bool is_significant) {
  if (!row.doubt.empty()) return "equal insignificant";
  return std::string(direction_class(change)) + (is_significant ? "" : " insignificant");
}

/// The cell of a change from 0: a difference, not a ratio.
std::string difference_cell(const bench::AblationRow& row, const std::string& lost) {
  const eval::PairedDifference& difference = *row.difference;
  return fmt::format(
      "<td class=\"{}\" style=\"--depth:54%\">{:+.4g}<span class=\"interval\">n = {}, from 0</span>{}</td>",
      cell_class(row, difference.median, eval::is_significant(difference)), difference.median,
      difference.count, lost);
}

std::string cell_html(const bench::AblationRow& row) {
  std::string lost = row.newly_failed == 0 ? "" : fmt::format("<br>{} lost", row.newly_failed);
  if (!row.doubt.empty()) lost += "<br>" + row.doubt;
  if (!row.change && row.difference) return difference_cell(row, lost);
  if (!row.change)
    return "<td class=\"empty\"><abbr tabindex=\"0\" title=\"no pair of successful runs\">n/a</abbr>" + lost +
           "</td>";
  const eval::RelativeChange& change = *row.change;
  return fmt::format("<td class=\"{}\" style=\"--depth:{}%\">{}<span class=\"interval\">{}</span>{}</td>",
                     cell_class(row, change.median, eval::is_significant(change)), color_depth(change.median),
                     percent_text(change.median), interval_text(change), lost);
}

std::string caption_html(const PlanAblation& ablation, const bench::MetricDescriptor& metric) {
  const std::string base =
      escape_html(ablation.base) +
      (ablation.is_base_of_plan ? ", base of plan " + escape_html(ablation.plan)
                                : ", which these variants of plan " + escape_html(ablation.plan) + " extend");
  return fmt::format(
      "<caption>Change of {} relative to {}: Hodges-Lehmann estimate over n pairs of equal sequence and "
      "seed (in the column all over n sequences, of one sequence over its pairs), and its exact 95 % "
      "interval (Wilcoxon signed-rank test); "
      "hatched: not significant, because the interval contains 0 or n is too small for one, or not "
      "comparable "
      "because a lost track leaves fewer frames. {}</caption>\n",
      metric.id, base, bench::tooltip(metric));
}

std::string head_html(const std::vector<std::string>& sequences) {
  std::string text =
      "<thead><tr><th scope=\"col\">variant</th>"
      "<th scope=\"col\">all</th>";
  for (const std::string& sequence : sequences)
    text += "<th scope=\"col\">" + escape_html(sequence) + "</th>";
  return text + "</tr></thead>";
}

}  // namespace

std::string heat_map_html(const PlanAblation& ablation, const bench::MetricDescriptor& metric) {
  const std::vector<bench::AblationRow> rows =
      bench::ablation(ablation.runs, ablation.base, std::string(metric.id));
  const bool has_pairs = std::any_of(rows.begin(), rows.end(), [](const bench::AblationRow& row) {
    return row.difference.has_value() || row.newly_failed > 0;
  });
  if (!has_pairs) return "";
  std::vector<std::string> columns =
      distinct(ablation.runs, [](const bench::RunIdentity& identity) { return identity.sequence; });
  std::string text = "<div class=\"table\"><table class=\"heat\">" + caption_html(ablation, metric) +
                     head_html(columns) + "<tbody>";
  columns.insert(columns.begin(), "");  // all sequences
  for (const std::string& variant : distinct(ablation.runs, system_label)) {
    if (variant == ablation.base) continue;
    text += "\n<tr><th scope=\"row\">" + escape_html(variant) + "</th>";
    for (const std::string& sequence : columns) {
      const auto found = std::find_if(rows.begin(), rows.end(), [&](const bench::AblationRow& row) {
        return row.variant == variant && row.sequence == sequence;
      });
      text += found == rows.end() ? "<td class=\"empty\">-</td>" : cell_html(*found);
    }
    text += "</tr>";
  }
  return text + "</tbody></table></div>\n";
}

}  // namespace stillpoint::report
