// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/published_comparison.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "bench/model/run_notes.h"
#include "eval/metrics/statistics.h"
#include "reports/tables/text_table.h"

namespace stillpoint::report {
namespace {

/// Values by variant and column, in the order of first appearance.
struct Measured {
  std::vector<std::string> variants;
  std::vector<std::string> columns;
  std::map<std::pair<std::string, std::string>, std::vector<double>> values;
  std::size_t disturbed = 0;  ///< runs that were omitted because other processes may have changed their times

  void add(const std::string& variant, const std::string& column, double value) {
    if (std::find(variants.begin(), variants.end(), variant) == variants.end()) variants.push_back(variant);
    if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    values[{variant, column}].push_back(value);
  }
};

Measured measured(std::span<const bench::StoredRun> runs, const bench::PublishedTable& published) {
  Measured table;
  for (const bench::StoredRun& run : runs) {
    if (run.outcome != bench::Outcome::kOk || !run.identity.axis.empty()) continue;
    if (published.metric == "mean_ms") {
      const bool is_disturbed = bench::time_source(run) != bench::TimeSource::kUndisturbed;
      table.disturbed += is_disturbed && !run.costs.empty() ? 1 : 0;
      if (is_disturbed) continue;
      for (const bench::ModuleCost& cost : run.costs)
        table.add(run.identity.variant, cost.module, cost.mean_ms);
    } else if (const std::optional<double> value = bench::metric_value(run, published.metric)) {
      table.add(run.identity.variant, run.identity.sequence, *value);
    }
  }
  return table;
}

/// Columns that also occur in a published row.
std::vector<std::string> shared_columns(const Measured& table, const bench::PublishedTable& published) {
  std::vector<std::string> shared;
  std::copy_if(
      table.columns.begin(), table.columns.end(), std::back_inserter(shared), [&](const std::string& column) {
        return std::any_of(published.rows.begin(), published.rows.end(),
                           [&](const bench::PublishedRow& row) { return row.values.contains(column); });
      });
  return shared;
}

std::string number(double value) { return fmt::format("{:.4f}", value); }

std::vector<std::string> published_cells(const bench::PublishedRow& row,
                                         const std::vector<std::string>& columns) {
  std::vector<std::string> cells = {bench::system_label(row), "published, " + row.source};
  for (const std::string& column : columns) {
    const auto found = row.values.find(column);
    cells.push_back(found == row.values.end() ? "-" : number(found->second));
  }
  return cells;
}

std::vector<std::string> measured_cells(const Measured& table, const std::string& variant,
                                        const std::vector<std::string>& columns) {
  std::vector<std::string> cells = {variant, "measured"};
  for (const std::string& column : columns) {
    const auto found = table.values.find({variant, column});
    cells.push_back(found == table.values.end() ? "n/a" : number(*eval::percentile(found->second, 0.5)));
  }
  return cells;
}

/// One line for each cell whose protocol differs much from a strict one of the same runs.
std::string protocol_lines(std::span<const bench::StoredRun> runs, const Measured& table,
                           const std::vector<std::string>& columns, const std::string& metric) {
  std::string text;
  for (const std::string& variant : table.variants) {
    for (const std::string& sequence : columns) {
      std::vector<const bench::StoredRun*> own;
      for (const bench::StoredRun& run : runs) {
        const bench::RunIdentity& identity = run.identity;
        if (identity.variant == variant && identity.sequence == sequence && identity.axis.empty())
          own.push_back(&run);
      }
      const std::string note = bench::protocol_difference_note(own, metric);
      if (!note.empty()) text += fmt::format("- {} on {}: {}\n", variant, sequence, note);
    }
  }
  return text;
}

std::string omission_sentence(std::size_t disturbed) {
  if (disturbed == 0) return "";
  return fmt::format(
      "The times of {} run{} are not compared, because only timing runs on an idle machine give times: "
      "execute a plan with kind = \"timing\" into a new store while the machine is idle.",
      disturbed, disturbed == 1 ? "" : "s");
}

}  // namespace

std::string published_comparison(std::span<const bench::StoredRun> runs,
                                 const bench::PublishedTable& published) {
  const Measured table = measured(runs, published);
  const std::vector<std::string> columns = shared_columns(table, published);
  const std::string omitted = omission_sentence(table.disturbed);
  if (columns.empty()) return omitted.empty() ? "" : published.title + ": " + omitted + "\n";
  TableRows rows = {{"system", "source"}};
  rows.front().insert(rows.front().end(), columns.begin(), columns.end());
  for (const std::string& variant : table.variants) rows.push_back(measured_cells(table, variant, columns));
  std::set<std::string> sources;
  std::string notes;
  for (const bench::PublishedRow& row : published.rows) {
    const bool any = std::any_of(columns.begin(), columns.end(),
                                 [&](const std::string& column) { return row.values.contains(column); });
    if (!any) continue;
    rows.push_back(published_cells(row, columns));
    sources.insert(row.source);
    if (!row.note.empty()) notes += fmt::format("- {} ({}): {}\n", row.system, row.source, row.note);
  }
  std::string text = fmt::format("{} [{}]; measured: medians; published: alignment {}\n\n", published.title,
                                 published.unit, published.alignment);
  text += format_table(rows, TableStyle::kMarkdown) + "\n";
  for (const std::string& sentence : published.comparability) text += "- " + sentence + "\n";
  if (!omitted.empty()) text += "- " + omitted + "\n";
  text += protocol_lines(runs, table, columns, published.metric);
  text += notes;
  for (const std::string& source : sources)
    text += fmt::format("- {}: {}\n", source, published.sources.at(source));
  return text;
}

}  // namespace stillpoint::report
