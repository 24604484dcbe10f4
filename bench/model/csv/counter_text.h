// SPDX-License-Identifier: BSD-3-Clause
/// Counters of the odometry as CSV: a header, then one line per frame.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

[[nodiscard]] std::string counter_text(std::span<const FrameCounters> frames);

/// @param place name of the text in messages
/// @throws InputError with the line of the first error
[[nodiscard]] std::vector<FrameCounters> parse_counters(std::string_view text, const std::string& place);

}  // namespace stillpoint::bench
