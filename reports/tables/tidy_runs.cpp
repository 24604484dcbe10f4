// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/tidy_runs.h"

#include <array>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

constexpr std::array kColumns = {
    "run",        "system",  "variant",  "sequence", "sequence_id", "config_hash", "build",      "committed",
    "started",    "machine", "mode",     "kind",     "cores",       "seed",        "repetition", "axis",
    "axis_value", "outcome", "protocol", "metric",   "unit",        "better",      "value"};

/// The columns that all rows of a run share, each followed by a comma.
std::string run_columns(const bench::StoredRun& run) {
  const bench::RunIdentity& id = run.identity;
  std::string text;
  for (const std::string_view part : std::initializer_list<std::string_view>{
           run.key, id.system, id.variant, id.sequence, id.sequence_id, id.config_hash, id.build,
           run.committed, run.started, run.machine, id.mode, id.kind, id.cores})
    text += csv_field(part) + ',';
  fmt::format_to(std::back_inserter(text), "{},{},{},", id.seed, id.repetition, csv_field(id.axis));
  if (!id.axis.empty()) fmt::format_to(std::back_inserter(text), "{}", id.axis_value);
  return text + ',' + bench::outcome_name(run.outcome) + ',';
}

std::string_view better_of(const std::string& metric) {
  const bench::MetricDescriptor* known = bench::find_metric(bench::without_protocol(metric));
  if (known == nullptr || known->direction == bench::MetricDirection::kNone) return "";
  return known->direction == bench::MetricDirection::kSmallerIsBetter ? "smaller" : "larger";
}

void add_row(const std::string& columns, const bench::Metric& metric, std::string_view better,
             std::string& text) {
  fmt::format_to(std::back_inserter(text), "{}{},{},{},{},{}\n", columns, csv_field(metric.protocol),
                 csv_field(metric.name), csv_field(metric.unit), better, metric.value);
}

void add_run(const bench::StoredRun& run, std::string& text) {
  const std::string columns = run_columns(run);
  const double succeeded = run.outcome == bench::Outcome::kOk ? 1.0 : 0.0;
  add_row(columns, {.name = "succeeded", .value = succeeded}, "larger", text);
  for (const bench::Metric& metric : run.metrics) add_row(columns, metric, better_of(metric.name), text);
  for (const bench::ModuleCost& cost : run.costs) {
    const auto add = [&](std::string_view statistic, double ms) {
      const std::string name = fmt::format("{}/{}", statistic, cost.module);
      add_row(columns, {.name = name, .protocol = "per " + cost.per, .unit = "ms", .value = ms}, "smaller",
              text);
    };
    add("mean_ms", cost.mean_ms);
    add("median_ms", cost.median_ms);
    add("p95_ms", cost.p95_ms);
    add("max_ms", cost.max_ms);
  }
}

}  // namespace

std::string tidy_header() { return fmt::format("{}", fmt::join(kColumns, ",")); }

std::string tidy_text(std::span<const bench::StoredRun> runs) {
  std::string text = tidy_header() + '\n';
  for (const bench::StoredRun& run : runs) add_run(run, text);
  return text;
}

}  // namespace stillpoint::report
