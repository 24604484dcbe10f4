// SPDX-License-Identifier: BSD-3-Clause
/// Ranges of the values of number options.
#pragma once

#include <string>

namespace stillpoint::bench {

/// Both ends are allowed. The default admits every number that a command can compute with; nan and inf never
/// are in a range.
struct NumberRange {
  double least = -1e9;
  double most = 1e9;
};

/// "must be from 1 to 1000, not nan"; empty if the value is within the range, or is not a number, which the
/// parser reports.
[[nodiscard]] std::string range_problem(const std::string& value, const NumberRange& range);

}  // namespace stillpoint::bench
