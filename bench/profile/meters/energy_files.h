// SPDX-License-Identifier: BSD-3-Clause
/// Sources of energy and power readings: RAPL of x86 processors, INA3221 sensors and `tegrastats` of Jetson
/// devices.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

/// Energy counter of a RAPL zone, e.g. "package-0". It wraps around at `range_uj`.
struct EnergyCounter {
  std::string name;
  std::int64_t energy_uj = 0;
  std::int64_t range_uj = 0;
};

/// Current power of one rail.
struct RailPower {
  std::string rail;
  double power_w = 0.0;
};

/// Top-level zones (packages), without subzones. Empty if there are none or they are not readable.
/// Source: Linux, Documentation/power/powercap/powercap.rst.
/// @param root "/", or a folder with a recorded "sys"
[[nodiscard]] std::vector<EnergyCounter> read_rapl(const std::filesystem::path& root);

/// Energy [J] between two readings of the same zones.
[[nodiscard]] double joules_between(const std::vector<EnergyCounter>& before,
                                    const std::vector<EnergyCounter>& after);

/// Rails of INA3221 sensors with the kernel driver hwmon (since JetPack 5: mV and mA) or iio (older, mW).
/// Source: Jetson Developer Guide, "Software-Based Power Consumption Modeling".
[[nodiscard]] std::vector<RailPower> read_ina3221(const std::filesystem::path& root);

/// Rails of a line of `tegrastats`: "VDD_IN 4060/4060", or with the unit "VDD_IN 4060mW/4060mW"; the first
/// number is the current power, the second the average.
/// Source: Jetson Developer Guide, "tegrastats Utility".
[[nodiscard]] std::vector<RailPower> parse_tegrastats(std::string_view line);

/// Rails of the last complete line of a log of `tegrastats --logfile`; empty if there is none yet.
[[nodiscard]] std::vector<RailPower> read_tegrastats(const std::filesystem::path& log);

/// Power of the input rail of the device ("VDD_IN", "POM_5V_IN"); without one, the sum of all rails.
[[nodiscard]] double device_power_w(const std::vector<RailPower>& rails);

}  // namespace stillpoint::bench
