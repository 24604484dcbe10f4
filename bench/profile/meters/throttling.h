// SPDX-License-Identifier: BSD-3-Clause
/// Whether the processor was slowed down because of its temperature or power.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace stillpoint::bench {

/// Readings of one moment, by the path of their file.
struct ThrottleState {
  std::map<std::string, std::int64_t> events;      ///< thermal_throttle counts since boot
  std::map<std::string, std::int64_t> limits_khz;  ///< largest allowed frequency of each cpufreq policy
  std::map<std::string, std::int64_t> cooling;     ///< state of cooling devices that are not fans; 0: off
  [[nodiscard]] bool is_available() const {
    return !(events.empty() && limits_khz.empty() && cooling.empty());
  }
};

/// Files that are not readable or contain no valid number are left out.
/// Source: Linux, "CPU Performance Scaling"; "Generic Thermal Sysfs".
/// @param root "/", or a folder with a recorded "sys"
[[nodiscard]] ThrottleState read_throttle_state(const std::filesystem::path& root);

/// Whether an event was counted, a limit of the frequency fell, or a cooling device became more active.
/// Nothing if no file is in both states.
[[nodiscard]] std::optional<bool> throttled_between(const ThrottleState& before, const ThrottleState& after);

}  // namespace stillpoint::bench
