// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/energy_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "bench/profile/meters/sysfs_values.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// The power of a rail below 1 kW, beyond which no device with these sensors is supplied.
std::optional<double> valid_power_w(double power_w) {
  constexpr double kLargestPowerW = 1000.0;
  return power_w >= 0.0 && power_w < kLargestPowerW ? std::optional(power_w) : std::nullopt;
}

std::optional<double> power_w(std::optional<std::int64_t> value, double unit_w) {
  return value ? valid_power_w(unit_w * static_cast<double>(*value)) : std::nullopt;
}

/// An INA3221 has three channels; hwmon ("in1_label") numbers them from 1, iio ("rail_name_0") from 0.
constexpr int kChannels = 3;

bool is_connected(const std::optional<std::string>& name) { return name && *name != "NC"; }

std::vector<RailPower> ina3221_hwmon_rails(const fs::path& folder) {
  std::vector<RailPower> rails;
  for (int i = 1; i <= kChannels; ++i) {
    const std::string number = std::to_string(i);
    const auto name = line_in(folder / ("in" + number + "_label"));
    if (!is_connected(name)) continue;
    const auto millivolts = number_in(folder / ("in" + number + "_input"));
    const auto milliamperes = number_in(folder / ("curr" + number + "_input"));
    std::optional<double> power;
    if (millivolts && milliamperes && *millivolts >= 0 && *milliamperes >= 0) {
      power = valid_power_w(1e-6 * static_cast<double>(*millivolts) * static_cast<double>(*milliamperes));
    }
    rails.push_back({*name, power});
  }
  return rails;
}

std::vector<RailPower> ina3221_iio_rails(const fs::path& folder) {
  std::vector<RailPower> rails;
  for (int i = 0; i < kChannels; ++i) {
    const std::string number = std::to_string(i);
    const auto name = line_in(folder / ("rail_name_" + number));
    if (!is_connected(name)) continue;
    rails.push_back({*name, power_w(number_in(folder / ("in_power" + number + "_input")), 1e-3)});
  }
  return rails;
}

/// The single channel of an INA238; Thor has one, at its input.
std::vector<RailPower> ina238_rails(const fs::path& folder) {
  const std::string name = line_in(folder / "in1_label").value_or("VIN");
  return {{name, power_w(number_in(folder / "power1_input"), 1e-6)}};
}

/// "4060/4060" or "4060mW/4060mW"; memory usage ("2457/15823MB") is not accepted.
std::optional<std::int64_t> current_power_mw(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto without_unit = [](std::string_view part) {
    return part.ends_with("mW") ? part.substr(0, part.size() - 2) : part;
  };
  const auto now = number_of(without_unit(text.substr(0, slash)));
  const auto mean = number_of(without_unit(text.substr(slash + 1)));
  if (!now || !mean) return std::nullopt;
  return now;
}

/// A counter that can have been read: not negative and within its range.
bool is_valid(const EnergyCounter& counter) {
  return counter.energy_uj && *counter.energy_uj >= 0 &&
         (counter.range_uj == 0 || *counter.energy_uj <= counter.range_uj);
}

}  // namespace

std::vector<EnergyCounter> read_rapl(const fs::path& root) {
  std::vector<EnergyCounter> counters;
  for (const fs::path& zone : entries_of(root / "sys/class/powercap", "intel-rapl:")) {
    const std::string id = zone.filename().string();
    if (std::ranges::count(id, ':') != 1) continue;  // "intel-rapl:0:1" is a subzone of "intel-rapl:0"
    const std::string name = line_in(zone / "name").value_or(id);
    if (name == "psys") continue;
    const std::int64_t range = number_in(zone / "max_energy_range_uj").value_or(0);
    counters.push_back({.name = name,
                        .energy_uj = number_in(zone / "energy_uj"),
                        .range_uj = std::max<std::int64_t>(range, 0)});
  }
  return counters;
}

std::optional<double> joules_between(const std::vector<EnergyCounter>& before,
                                     const std::vector<EnergyCounter>& after) {
  if (before.empty() || before.size() != after.size()) return std::nullopt;
  double sum_uj = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].name != after[i].name || !is_valid(before[i]) || !is_valid(after[i])) return std::nullopt;
    std::int64_t spent = *after[i].energy_uj - *before[i].energy_uj;
    if (spent < 0) spent += after[i].range_uj;
    if (spent < 0) return std::nullopt;
    sum_uj += static_cast<double>(spent);
  }
  return 1e-6 * sum_uj;
}

std::vector<RailPower> read_power_sensors(const fs::path& root) {
  std::vector<RailPower> rails;
  const auto add = [&](const std::vector<RailPower>& more) {
    rails.insert(rails.end(), more.begin(), more.end());
  };
  const fs::path i2c = root / "sys/bus/i2c/drivers";
  for (const char* name : {"ina3221", "ina3221x"}) {
    for (const fs::path& device : entries_of(i2c / name, "")) {
      for (const fs::path& folder : entries_of(device / "hwmon", "hwmon")) add(ina3221_hwmon_rails(folder));
      for (const fs::path& folder : entries_of(device, "iio:device")) add(ina3221_iio_rails(folder));
    }
  }
  for (const fs::path& device : entries_of(i2c / "ina238", "")) {
    for (const fs::path& folder : entries_of(device / "hwmon", "hwmon")) add(ina238_rails(folder));
  }
  return rails;
}

std::vector<RailPower> parse_tegrastats(std::string_view line) {
  std::vector<RailPower> rails;
  std::istringstream words{std::string(line)};
  std::string name;
  for (std::string word; words >> word; name = word) {
    if (const auto milliwatts = current_power_mw(word)) rails.push_back({name, power_w(milliwatts, 1e-3)});
  }
  return rails;
}

std::vector<RailPower> read_tegrastats(const fs::path& log) {
  std::ifstream file(log);
  std::string whole, line;
  while (std::getline(file, line) && !file.eof()) whole.swap(line);
  return parse_tegrastats(whole);
}

std::optional<double> device_power_w(const std::vector<RailPower>& rails) {
  constexpr std::array<std::string_view, 3> kInputs = {"VDD_IN", "POM_5V_IN", "VIN"};
  for (const RailPower& rail : rails) {
    if (std::ranges::find(kInputs, rail.rail) != kInputs.end()) return rail.power_w;
  }
  if (rails.empty()) return std::nullopt;
  double sum = 0.0;
  for (const RailPower& rail : rails) {
    if (!rail.power_w) return std::nullopt;
    sum += *rail.power_w;
  }
  return sum;
}

}  // namespace stillpoint::bench
