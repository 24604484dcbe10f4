// SPDX-License-Identifier: BSD-3-Clause
/// The result table of a plan: runs aggregated into rows, as a Markdown table and as JSON.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/model/run_notes.h"
#include "bench/plan/plan_matrix.h"
#include "bench/store/store.h"
#include "core/base/module_timings.h"

namespace stillpoint::bench {

/// The runs of one variant on one sequence. Metrics are medians over the succeeded runs; absent ones are
/// shown as "n/a".
struct BenchRow {
  std::string sequence;
  std::string variant;
  std::string sweep;               ///< "key = value"; empty outside a sweep
  bool is_available = true;        ///< the sequence exists
  std::optional<Outcome> outcome;  ///< of the first run that did not succeed, else kOk; nullopt: no run
  std::string reason;              ///< reason of a status other than "ok", or a warning
  std::size_t runs = 0;            ///< executed
  std::size_t succeeded_runs = 0;  ///< executed with outcome "ok"
  std::map<std::string, double, std::less<>> metrics;  ///< by id, of `MetricSource::kTrajectory`
  std::optional<double> worst;                         ///< of the headline metric, over the succeeded runs
  std::optional<std::size_t> modes;                    ///< of the same, see eval/statistics/modes.h
  std::array<std::optional<double>, kModuleCount> mean_ms;
  TimeSource time_source = TimeSource::kUndisturbed;  ///< of `mean_ms`: the worst among the runs
};

/// All rows of a plan in its order, including those without executed runs.
[[nodiscard]] std::vector<BenchRow> plan_rows(const PlanMatrix& matrix, const Store& store);

/// A Markdown table with aligned columns, followed by the reasons of rows that are not ok. Timings are means
/// [ms], modules per call and threads per frame; modules without any timing are omitted.
[[nodiscard]] std::string markdown_table(std::span<const BenchRow> rows);

/// The same rows as a JSON document, numbers with full precision.
[[nodiscard]] std::string json_table(const std::string& title, std::span<const BenchRow> rows);

}  // namespace stillpoint::bench
