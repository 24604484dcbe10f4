// SPDX-License-Identifier: BSD-3-Clause
/// Folded stacks of many runs put together, for a flame chart.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace stillpoint {

/// Stack "outer;inner" -> time spent in its innermost part alone [ns].
using StackTimes = std::map<std::string, double>;

/// Adds the lines "outer;inner ns" of a file.
/// @param place name of the text in messages
/// @throws InputError with the line of the first fault
void add_stacks(StackTimes& times, std::string_view folded, const std::string& place);

}  // namespace stillpoint
