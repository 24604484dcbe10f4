// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/tidy_runs.h"

#include <array>
#include <string_view>

#include <fmt/format.h>

#include "bench/model/metrics.h"

namespace stillpoint::report {
namespace {

constexpr std::array kColumns = {
    "run",        "system",  "variant",  "sequence", "sequence_id", "config_hash", "build",      "committed",
    "started",    "machine", "mode",     "kind",     "cores",       "seed",        "repetition", "axis",
    "axis_value", "outcome", "protocol", "metric",   "unit",        "better",      "value"};

/// The values that all rows of a run share, in the first columns.
DataRow run_values(const bench::StoredRun& run) {
  const bench::RunIdentity& id = run.identity;
  DataRow values;
  for (const std::string& text :
       {run.key, id.system, id.variant, id.sequence, id.sequence_id, id.config_hash, id.build, run.committed,
        run.started, run.machine, id.mode, id.kind, id.cores})
    values.push_back(data_value(text));
  const DataRow more = {id.seed, id.repetition, data_value(id.axis),
                        id.axis.empty() ? DataValue() : DataValue(id.axis_value),
                        bench::outcome_name(run.outcome)};
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

std::string_view better_of(const std::string& metric) {
  const bench::MetricDescriptor* known = bench::find_metric(bench::without_protocol(metric));
  if (known == nullptr || known->direction == bench::MetricDirection::kNone) return "";
  return known->direction == bench::MetricDirection::kSmallerIsBetter ? "smaller" : "larger";
}

DataRow metric_row(DataRow values, const bench::Metric& metric, std::string_view better) {
  const DataRow more = {data_value(metric.protocol), metric.name, data_value(metric.unit),
                        data_value(std::string(better)), metric.value};
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

void add_run(const bench::StoredRun& run, std::vector<DataRow>& rows) {
  const DataRow values = run_values(run);
  const double succeeded = run.outcome == bench::Outcome::kOk ? 1.0 : 0.0;
  rows.push_back(metric_row(values, {.name = "succeeded", .value = succeeded}, "larger"));
  for (const bench::Metric& metric : run.metrics)
    rows.push_back(metric_row(values, metric, better_of(metric.name)));
  for (const bench::ModuleCost& cost : run.costs) {
    const auto add = [&](std::string_view statistic, double ms) {
      const std::string name = fmt::format("{}/{}", statistic, cost.module);
      rows.push_back(metric_row(
          values, {.name = name, .protocol = "per " + cost.per, .unit = "ms", .value = ms}, "smaller"));
    };
    add("mean_ms", cost.mean_ms);
    add("median_ms", cost.median_ms);
    add("p95_ms", cost.p95_ms);
    add("max_ms", cost.max_ms);
  }
}

}  // namespace

std::string tidy_header() { return fmt::format("{}", fmt::join(kColumns, ",")); }

DataTable tidy_table(std::span<const bench::StoredRun> runs) {
  DataTable table{
      .kind = "store_runs", .columns = {kColumns.begin(), kColumns.end()}, .rows = {}, .notes = {}};
  for (const bench::StoredRun& run : runs) add_run(run, table.rows);
  return table;
}

std::string tidy_text(std::span<const bench::StoredRun> runs) {
  std::string text = tidy_header() + '\n';
  for (const bench::StoredRun& run : runs) text += data_rows_csv(tidy_table(std::span(&run, 1)).rows);
  return text;
}

}  // namespace stillpoint::report
