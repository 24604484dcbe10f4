// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/throttling.h"

#include "bench/profile/meters/sysfs_values.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

using Readings = std::map<std::string, std::int64_t>;

Readings with(Readings readings, const fs::path& file) {
  const std::optional<std::int64_t> value = number_in(file);
  if (value && *value >= 0) readings[file.string()] = *value;
  return readings;
}

bool is_fan(const fs::path& cooling_device) {
  const std::string type = line_in(cooling_device / "type").value_or("");
  return type.find("fan") != std::string::npos || type.find("Fan") != std::string::npos;
}

/// Comparison of two states of one kind: whether `is_worse` holds for any file; nothing without common files.
template <typename Compare>
std::optional<bool> any_worse(const Readings& before, const Readings& after, Compare is_worse) {
  std::optional<bool> worse;
  for (const auto& [file, value] : before) {
    const auto found = after.find(file);
    if (found != after.end()) worse = worse.value_or(false) || is_worse(found->second, value);
  }
  return worse;
}

}  // namespace

ThrottleState read_throttle_state(const fs::path& root) {
  ThrottleState state;
  for (const fs::path& cpu : entries_of(root / "sys/devices/system/cpu", "cpu")) {
    for (const char* counter : {"core_throttle_count", "package_throttle_count"})
      state.events = with(std::move(state.events), cpu / "thermal_throttle" / counter);
  }
  for (const fs::path& policy : entries_of(root / "sys/devices/system/cpu/cpufreq", "policy"))
    state.limits_khz = with(std::move(state.limits_khz), policy / "scaling_max_freq");
  for (const fs::path& device : entries_of(root / "sys/class/thermal", "cooling_device")) {
    if (!is_fan(device)) state.cooling = with(std::move(state.cooling), device / "cur_state");
  }
  return state;
}

std::optional<bool> throttled_between(const ThrottleState& before, const ThrottleState& after) {
  const auto events = any_worse(before.events, after.events, std::greater<>());
  const auto limits = any_worse(before.limits_khz, after.limits_khz, std::less<>());
  const auto cooling = any_worse(before.cooling, after.cooling, std::greater<>());
  if (!events && !limits && !cooling) return std::nullopt;
  return events.value_or(false) || limits.value_or(false) || cooling.value_or(false);
}

}  // namespace stillpoint::bench
