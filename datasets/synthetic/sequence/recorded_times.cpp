// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/recorded_times.h"

#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::synth {
namespace {

Timestamp time_of(const std::string& field, const std::string& place) {
  const std::optional<Timestamp> time = eval::parse_stamp(field);
  if (!time) throw InputError(place, "\"" + field + "\" is not a time; expected seconds");
  constexpr std::int64_t kMicrosecond_ns = 1000;
  return {time->ns / kMicrosecond_ns * kMicrosecond_ns};
}

}  // namespace

FrameTimes load_recorded_times(const std::filesystem::path& file, double seconds) {
  std::ifstream input(file);
  FrameTimes times;
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    std::istringstream fields(line);
    std::string color, name, depth;
    if (!(fields >> color) || color.starts_with('#')) continue;
    const std::string place = file.string() + ":" + std::to_string(number);
    const Timestamp t = time_of(color, place);
    if (!times.color.empty() && seconds_between(times.color.front(), t) >= seconds) break;
    if (!times.color.empty() && t <= times.color.back())
      throw InputError(place, "the time does not increase; sort the file");
    times.color.push_back(t);
    times.depth.push_back(fields >> name >> depth ? time_of(depth, place) : t);
  }
  if (times.color.empty())
    throw InputError(file.string(), "cannot be read or contains no time; pass lines of `TIME [NAME TIME]`");
  return times;
}

}  // namespace stillpoint::synth
