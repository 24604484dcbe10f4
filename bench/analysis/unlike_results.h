// SPDX-License-Identifier: BSD-3-Clause
/// What base and head have both, but not measured in the same way, so that it is not compared: other data
/// under the same name, another kind of run, protocol, unit, machine, or order of measurement.
///
/// Times are compared only if both sides were measured on the same machine and at the same time: a machine
/// that becomes 5 % slower makes all times of the later side worse. Over the start times b_i of base and h_j
/// of head
///
///   A = (#{(i, j): b_i < h_j} + 1/2 #{(i, j): b_i = h_j}) / (m n),  interleaved: 1/4 <= A <= 3/4
///
/// A is 1/2 for the order base, head, head, base, and 0 or 1 if one side was measured after the other.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/analysis/paired_runs.h"
#include "bench/model/metrics.h"
#include "eval/statistics/rank_tests.h"

namespace stillpoint::bench {

struct UnlikeResult {
  std::string what;     ///< "data", "kind", "protocol of ate_rmse_m", "machine of times", ...
  std::string subject;  ///< variant, or "variant on sequence"
  std::string base;     ///< how it was measured at base
  std::string head;
};

/// Differences that prevent a comparison; each once per subject. Empty values are unknown, and differ from
/// nothing.
[[nodiscard]] std::vector<UnlikeResult> unlike_results(const PairedRuns& runs);

/// Values of a metric with the same protocol and unit on both sides.
/// @return nullopt if a side lacks it, or its value is not finite
[[nodiscard]] std::optional<eval::Pair> comparable_values(const RunPair& pair, std::string_view metric);

/// Whether the times of a pair may be compared: same machine, as far as it is known.
[[nodiscard]] bool on_same_machine(const RunPair& pair);

/// Whether a metric is a time, which depends on machine and order of measurement.
[[nodiscard]] bool is_time(const MetricDescriptor& metric);

/// Whether both sides were measured at the same time; true also if no start is known.
[[nodiscard]] bool is_interleaved(const std::vector<RunPair>& pairs);

/// Whether the costs of a run decide: it was made to measure them. Other runs share the machine.
[[nodiscard]] bool measures_costs(const RunIdentity& identity);

}  // namespace stillpoint::bench
