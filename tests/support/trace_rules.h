// SPDX-License-Identifier: BSD-3-Clause
/// The rules of the Trace Event Format for complete events, as far as viewers depend on them.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace stillpoint {

/// What is wrong with a trace; nothing for a valid one. On each track events begin in order and lie either
/// within one another or apart, and every track has a name.
[[nodiscard]] inline std::vector<std::string> trace_faults(const nlohmann::json& trace) {
  std::vector<std::string> faults;
  std::map<int, std::vector<std::int64_t>> open_ends;  // of each track, the outermost first [ns]
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
    if (event.at("ph") != "X") faults.push_back(name + ": not a complete event");
    if (!event.at("pid").is_number_integer()) faults.push_back(name + ": no process");
    if (!named[track]) faults.push_back(name + ": on a track without a name");
    const std::int64_t start = nanoseconds(event.at("ts"));
    const std::int64_t end = start + nanoseconds(event.at("dur"));
    if (start < 0 || end < start) faults.push_back(name + ": negative time");
    if (last_start.contains(track) && start < last_start[track])
      faults.push_back(name + ": goes back in time");
    last_start[track] = start;
    std::vector<std::int64_t>& ends = open_ends[track];
    while (!ends.empty() && ends.back() <= start) ends.pop_back();
    if (!ends.empty() && end > ends.back()) faults.push_back(name + ": overlaps");
    ends.push_back(end);
  }
  return faults;
}

}  // namespace stillpoint
