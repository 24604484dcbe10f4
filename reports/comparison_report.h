// SPDX-License-Identifier: BSD-3-Clause
/// A comparison of two builds as Markdown for a merge request, as JSON, and as JUnit for servers that run
/// tests.
#pragma once

#include <string>

#include "bench/compare/comparison.h"

namespace stillpoint {

/// What was compared with what, as a reader knows it.
struct ComparisonTitle {
  std::string base;
  std::string head;
};

[[nodiscard]] std::string comparison_markdown(const ComparisonTitle& title, const Comparison& comparison);
[[nodiscard]] std::string comparison_json(const ComparisonTitle& title, const Comparison& comparison);

/// One test case for each metric; worse is a failure, inconclusive is skipped.
[[nodiscard]] std::string comparison_junit(const ComparisonTitle& title, const Comparison& comparison);

}  // namespace stillpoint
