// SPDX-License-Identifier: BSD-3-Clause
/// Energy and power as machines tell them: RAPL of x86 processors, INA3221 sensors and `tegrastats` of Jetson
/// boards.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// A counter of a RAPL zone, e.g. "package-0". It starts anew at `range_uj`.
struct EnergyCounter {
  std::string name;
  std::int64_t energy_uj = 0;
  std::int64_t range_uj = 0;
};

/// Power of one rail now.
struct RailPower {
  std::string rail;
  double power_w = 0.0;
};

/// Zones of processors, not their parts. Empty where there are none or they may not be read.
/// Source: Linux, Documentation/power/powercap/powercap.rst.
/// @param root "/", or a folder with a recorded "sys"
[[nodiscard]] std::vector<EnergyCounter> read_rapl(const std::filesystem::path& root);

/// [J] between two readings of the same zones.
[[nodiscard]] double joules_between(const std::vector<EnergyCounter>& before,
                                    const std::vector<EnergyCounter>& after);

/// Rails of INA3221 sensors under the hwmon driver (JetPack 5 on: mV and mA) or the older iio driver (mW).
/// Source: Jetson Developer Guide, "Software-Based Power Consumption Modeling".
[[nodiscard]] std::vector<RailPower> read_ina3221(const std::filesystem::path& root);

/// Rails of a line of `tegrastats`: "VDD_IN 4060/4060", or with the unit "VDD_IN 4060mW/4060mW"; the first
/// number is the present one.
/// Source: Jetson Developer Guide, "tegrastats Utility".
[[nodiscard]] std::vector<RailPower> parse_tegrastats(std::string_view line);

/// The same of the last whole line of a log that `tegrastats --logfile` writes; empty where there is none
/// yet.
[[nodiscard]] std::vector<RailPower> read_tegrastats(const std::filesystem::path& log);

/// The rail that feeds the whole board where there is one ("VDD_IN", "POM_5V_IN"), else the sum of all.
[[nodiscard]] double board_power_w(const std::vector<RailPower>& rails);

}  // namespace stillpoint
