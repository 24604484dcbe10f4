// SPDX-License-Identifier: BSD-3-Clause
/// Comparison of two builds as Markdown for a merge request, as JSON, and as JUnit XML for CI servers.
#pragma once

#include <string>

#include "bench/analysis/comparison.h"

namespace stillpoint::report {

/// Display names of the compared builds.
struct ComparisonTitle {
  std::string base;
  std::string head;
};

[[nodiscard]] std::string comparison_markdown(const ComparisonTitle& title,
                                              const bench::Comparison& comparison);
[[nodiscard]] std::string comparison_json(const ComparisonTitle& title, const bench::Comparison& comparison);

/// One test case per metric; "worse" is a failure, "inconclusive" is reported as skipped. A comparison
/// without a result is an error.
[[nodiscard]] std::string comparison_junit(const ComparisonTitle& title, const bench::Comparison& comparison);

}  // namespace stillpoint::report
