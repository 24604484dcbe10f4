// SPDX-License-Identifier: BSD-3-Clause
/// Rows as one table, for people and for programs.
#pragma once

#include <span>
#include <string>

#include "bench/plan/bench_row.h"

namespace stillpoint {

/// A Markdown table with aligned columns, followed by the reasons of rows that are not ok. Timings are means
/// [ms], modules per call and threads per frame; modules that no row has are left out.
[[nodiscard]] std::string markdown_table(std::span<const BenchRow> rows);

/// The same as a JSON document, numbers in full.
[[nodiscard]] std::string json_table(const std::string& title, std::span<const BenchRow> rows);

}  // namespace stillpoint
