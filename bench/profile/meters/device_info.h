// SPDX-License-Identifier: BSD-3-Clause
/// Processors, power mode, temperatures and power rails of the machine.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/profile/meters/energy_files.h"

namespace stillpoint::bench {

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
