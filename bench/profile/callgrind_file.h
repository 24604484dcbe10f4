// SPDX-License-Identifier: BSD-3-Clause
/// Reads what Valgrind's callgrind counted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace stillpoint {

/// Executed instructions, by function as callgrind names it (with its parameters).
struct CallgrindCounts {
  std::int64_t total = 0;
  std::map<std::string, std::int64_t> self;       ///< without what it called
  std::map<std::string, std::int64_t> inclusive;  ///< of all calls of it, with what it called
};

/// @param text  callgrind.out of one event, "Ir"; names may be compressed, as they are by default
/// @param place name of the text in messages
/// @throws InputError with the line of the first fault
/// Source: Callgrind Format Specification, Valgrind manual 3.19.
[[nodiscard]] CallgrindCounts parse_callgrind(std::string_view text, const std::string& place);

}  // namespace stillpoint
