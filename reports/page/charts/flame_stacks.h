// SPDX-License-Identifier: BSD-3-Clause
/// Parses folded stacks, for a flame chart.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace stillpoint::report {

/// Stack "outer;inner" -> self time of the innermost entry [ns].
using StackTimes = std::map<std::string, double>;

/// Sums the lines "outer;inner ns" of a file by stack.
/// @param source name of the text in error messages
/// @throws InputError with the number of the first invalid line
[[nodiscard]] StackTimes parse_stacks(std::string_view folded, const std::string& source);

}  // namespace stillpoint::report
