// SPDX-License-Identifier: BSD-3-Clause
/// Relative changes as text: size, number of values, and interval.
#pragma once

#include <string>

#include "eval/statistics/paired.h"

namespace stillpoint::report {

/// "+5.2 %" of the ratio 0.052.
[[nodiscard]] std::string percent_text(double ratio);

/// "n = 8, +4.1 to +6.0 %", or "n = 3, no interval" if the number of values does not support one.
[[nodiscard]] std::string interval_text(const eval::RelativeChange& change);

}  // namespace stillpoint::report
