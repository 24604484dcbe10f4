// SPDX-License-Identifier: BSD-3-Clause
/// Sources of energy and power readings: RAPL of x86 processors, INA3221 and INA238 sensors and `tegrastats`
/// of Jetson devices. A value that is missing, not readable, negative or beyond the range of the sensor is
/// no value, and a sum that lacks a part is none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Power of the input rail of the device ("VDD_IN", "POM_5V_IN", "VIN"); without one, the sum of all rails.
/// Nothing without rails, or if a rail that is used has no valid value.
[[nodiscard]] std::optional<double> device_power_w(const std::vector<RailPower>& rails);

}  // namespace stillpoint::bench
