// SPDX-License-Identifier: BSD-3-Clause
/// Formats rows as a Markdown table and as JSON.
#pragma once

#include <span>
#include <string>

#include "bench/plan/execution/bench_row.h"

namespace stillpoint::bench {

/// A Markdown table with aligned columns, followed by the reasons of rows that are not ok. Timings are means
/// [ms], modules per call and threads per frame; modules without any timing are omitted.
[[nodiscard]] std::string markdown_table(std::span<const BenchRow> rows);

/// The same rows as a JSON document, numbers with full precision.
[[nodiscard]] std::string json_table(const std::string& title, std::span<const BenchRow> rows);

}  // namespace stillpoint::bench
