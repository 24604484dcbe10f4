// SPDX-License-Identifier: BSD-3-Clause
/// Ablation heat map: relative change of each variant against a base per sequence, as a colored HTML table.
#pragma once

#include <span>
#include <string>

#include "bench/model/metrics.h"

namespace stillpoint::report {

/// Baseline of the ablation: the first of dynamic_vins, stillpoint and vo that was run, else the first
/// variant.
[[nodiscard]] std::string base_variant(std::span<const bench::StoredRun> runs);

/// Relative changes of a metric with their intervals, paired by sequence and seed; warm colors are worse.
/// Empty with fewer than two variants.
[[nodiscard]] std::string heat_map_html(std::span<const bench::StoredRun> runs, const std::string& base,
                                        const bench::MetricDescriptor& metric);

}  // namespace stillpoint::report
