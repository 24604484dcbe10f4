// SPDX-License-Identifier: BSD-3-Clause
/// What the odometry counted at each frame, as text: a line for each frame, after one that names the columns.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/store/stored_run.h"

namespace stillpoint {

[[nodiscard]] std::string counter_text(std::span<const FrameCounters> frames);

/// @param place name of the text in messages
/// @throws InputError with the line of the first fault
[[nodiscard]] std::vector<FrameCounters> parse_counters(std::string_view text, const std::string& place);

}  // namespace stillpoint
