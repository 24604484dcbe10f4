// SPDX-License-Identifier: BSD-3-Clause
/// State of the machine at one moment, from files of /sys, /proc and /etc: processors, power mode,
/// temperatures, throttling, and sources of energy and power readings, which are RAPL of x86 processors, and
/// INA3221 and INA238 sensors and `tegrastats` of Jetson devices. A value that is missing, not readable,
/// negative or beyond the range of the sensor is no value, and a sum that lacks a part is none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace stillpoint::bench {

/// Energy counter of a RAPL zone, e.g. "package-0". It wraps around at `range_uj`.
struct EnergyCounter {
  std::string name;
  std::optional<std::int64_t> energy_uj{};  ///< nothing if it is not readable
  std::int64_t range_uj = 0;                ///< 0: unknown
};

/// Current power of one rail.
struct RailPower {
  std::string rail;
  std::optional<double> power_w{};  ///< nothing if the rail exists, but its value is not valid
};

/// The packages: top-level zones without "psys", which contains the packages. Empty if there are none. Since
/// 2020 Linux lets only root read the counters.
/// Source: Linux, Documentation/power/powercap/powercap.rst.
/// @param root "/", or a folder with a recorded "sys"
[[nodiscard]] std::vector<EnergyCounter> read_rapl(const std::filesystem::path& root);

/// Energy [J] between two readings. Nothing if the zones differ, one is not readable or beyond its range, or
/// a counter of unknown range wrapped around. A counter must not wrap around twice between the readings.
[[nodiscard]] std::optional<double> joules_between(const std::vector<EnergyCounter>& before,
                                                   const std::vector<EnergyCounter>& after);

/// Rails of INA3221 sensors with the kernel driver hwmon (since JetPack 5: mV and mA) or iio (older, mW), and
/// of INA238 sensors (hwmon, uW; the input of Thor). Channels without a label or named "NC" are not
/// connected. Source: Jetson Developer Guide, "Software-Based Power Consumption Modeling"; Linux,
/// Documentation/hwmon/ina3221.rst, ina238.rst.
[[nodiscard]] std::vector<RailPower> read_power_sensors(const std::filesystem::path& root);

/// Rails of a line of `tegrastats`: "VDD_IN 4060/4060", or with the unit "VDD_IN 4060mW/4060mW"; the first
/// number is the current power, the second the average.
/// Source: Jetson Developer Guide, "tegrastats Utility".
[[nodiscard]] std::vector<RailPower> parse_tegrastats(std::string_view line);

/// Rails of the last complete line of a log of `tegrastats --logfile`; empty if there is none yet.
[[nodiscard]] std::vector<RailPower> read_tegrastats(const std::filesystem::path& log);

/// @throws InputError with the line if the last complete line of the log has no rail
void require_tegrastats(const std::filesystem::path& log);

/// Power of the input rail of the device ("VDD_IN", "POM_5V_IN", "VIN"); without one, the sum of all rails.
/// Nothing without rails, or if a rail that is used has no valid value.
[[nodiscard]] std::optional<double> device_power_w(const std::vector<RailPower>& rails);

/// What slows the processor down because of its temperature or power: readings of one moment, by the path of
/// their file.
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

struct ThermalZone {
  std::string name;
  std::optional<double> celsius{};  ///< nothing if the sensor is off or its value is not valid
};

/// Nothing where a value is not available.
struct DeviceInfo {
  std::optional<std::string> model{};         ///< of the device tree, or of the mainboard
  std::optional<std::string> cores_online{};  ///< list as of the kernel, e.g. "0-3,6"
  std::optional<std::string> cores_present{};
  std::optional<std::string> governor{};        ///< of all cpufreq policies, joined by "," if they differ
  std::optional<double> frequency_limit_mhz{};  ///< largest allowed frequency of any policy
  std::optional<std::string> nvpmodel{};        ///< power mode of a Jetson, e.g. "MAXN (0)"
  std::optional<std::string> jetpack{};         ///< e.g. "JetPack 5 (L4T R35.4.1)"
  std::vector<ThermalZone> thermal_zones{};
  std::vector<RailPower> power_rails{};
  std::vector<EnergyCounter> energy_counters{};
};

/// Source: Linux, "Generic Thermal Sysfs"; Jetson Developer Guide, "nvpmodel".
/// @param root "/", or a folder with recorded "sys", "proc", "etc" and "var"
[[nodiscard]] DeviceInfo device_info(const std::filesystem::path& root);

/// Temperature of the hottest zone [deg C]; nothing if none is valid.
[[nodiscard]] std::optional<double> hottest_celsius(const std::filesystem::path& root);

/// Null for values that are not available.
[[nodiscard]] nlohmann::ordered_json device_json(const DeviceInfo& device);

}  // namespace stillpoint::bench
