// SPDX-License-Identifier: BSD-3-Clause
/// Metrics for which a strict evaluation protocol of the same runs gives a very different value.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Factor between two protocols from which on a value is not shown without the other one.
inline constexpr double kMaxProtocolFactor = 2.0;

/// Footnote about a metric for which a "strict:*" protocol differs by `kMaxProtocolFactor` or more, in either
/// direction and by more than the floor of the metric's gate, in at least one run: "ATE 0.0021 m by
/// compat:tum, 0.0089 m by strict:se3 (medians of 3 runs; differ by a factor of 2 or more in 1)".
/// @param runs of one variant on one sequence; failed ones are ignored
/// @param metric id, e.g. "ate_rmse_m"
/// @return names both protocols and both values; empty without such a difference
[[nodiscard]] std::string protocol_difference_note(std::span<const StoredRun* const> runs,
                                                   std::string_view metric);

}  // namespace stillpoint::bench
