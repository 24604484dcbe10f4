// SPDX-License-Identifier: BSD-3-Clause
/// Timing samples as text: `frame,module,ns,calls` a line, after a line that names the columns.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/store/stored_run.h"

namespace stillpoint {

[[nodiscard]] std::string timing_text(std::span<const TimingSample> samples);

/// @param place name of the text in messages
/// @throws InputError with the line of the first fault
[[nodiscard]] std::vector<TimingSample> parse_timings(std::string_view text, const std::string& place);

}  // namespace stillpoint
