// SPDX-License-Identifier: BSD-3-Clause
/// Parser of Valgrind's callgrind output.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace stillpoint::bench {

/// Executed instructions by function, with callgrind's function names (including parameter types).
struct CallgrindCounts {
  std::int64_t total = 0;
  std::map<std::string, std::int64_t> self;       ///< without callees
  std::map<std::string, std::int64_t> inclusive;  ///< with callees, summed over all calls
};

/// @param text  callgrind.out with the single event "Ir"; names may be compressed (the default)
/// @param place name of the text in messages
/// @throws InputError with the line of the first error
/// Source: Callgrind Format Specification, Valgrind manual 3.19.
[[nodiscard]] CallgrindCounts parse_callgrind(std::string_view text, const std::string& place);

}  // namespace stillpoint::bench
