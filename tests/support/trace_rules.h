// SPDX-License-Identifier: BSD-3-Clause
/// Checks of the Trace Event Format for complete events, as required by trace viewers.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace stillpoint {

/// Format errors of a trace; empty if valid. On each track, events are ordered by start time and either
/// nested or disjoint; every track has a name.
[[nodiscard]] inline std::vector<std::string> trace_format_errors(const nlohmann::json& trace) {
  std::vector<std::string> errors;
  std::map<int, std::vector<std::int64_t>> open_ends;  // per track, outermost event first [ns]
  std::map<int, std::int64_t> last_start;
  std::map<int, bool> named;
  const auto nanoseconds = [](const nlohmann::json& us) { return std::llround(us.get<double>() * 1e3); };
  for (const auto& event : trace.at("traceEvents")) {
    const int track = event.at("tid").get<int>();
    if (event.at("ph") == "M") {
      named[track] = !event.at("args").at("name").get<std::string>().empty();
      continue;
    }
    const std::string name = event.at("name").get<std::string>();
    if (event.at("ph") != "X") errors.push_back(name + ": not a complete event");
    if (!event.at("pid").is_number_integer()) errors.push_back(name + ": no process");
    if (!named[track]) errors.push_back(name + ": on a track without a name");
    const std::int64_t start = nanoseconds(event.at("ts"));
    const std::int64_t end = start + nanoseconds(event.at("dur"));
    if (start < 0 || end < start) errors.push_back(name + ": negative time");
    if (last_start.contains(track) && start < last_start[track])
      errors.push_back(name + ": goes back in time");
    last_start[track] = start;
    std::vector<std::int64_t>& ends = open_ends[track];
    while (!ends.empty() && ends.back() <= start) ends.pop_back();
    if (!ends.empty() && end > ends.back()) errors.push_back(name + ": overlaps");
    ends.push_back(end);
  }
  return errors;
}

}  // namespace stillpoint
