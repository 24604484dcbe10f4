// SPDX-License-Identifier: BSD-3-Clause
/// Timing samples as CSV with the columns `frame,module,ns,calls`.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

[[nodiscard]] std::string timing_text(std::span<const TimingSample> samples);

/// @param place name of the text in messages
/// @throws InputError with the line of the first error
[[nodiscard]] std::vector<TimingSample> parse_timings(std::string_view text, const std::string& place);

}  // namespace stillpoint::bench
