// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/device_info.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCpuFolder = "sys/devices/system/cpu";

/// First line without surrounding white space and zero bytes; nothing if it is empty or not readable.
std::optional<std::string> line_in(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return std::nullopt;
  constexpr std::string_view kBlank(" \t\r\n\0", 5);  // texts of the device tree end with a zero byte
  const std::size_t begin = line.find_first_not_of(kBlank);
  if (begin == std::string::npos) return std::nullopt;
  return line.substr(begin, line.find_last_not_of(kBlank) - begin + 1);
}

/// Nothing unless the whole text is one decimal integer that fits 64 bits.
std::optional<std::int64_t> number_of(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The number of a file that contains nothing else in its first line.
std::optional<std::int64_t> number_in(const fs::path& file) {
  const std::optional<std::string> line = line_in(file);
  return line ? number_of(*line) : std::nullopt;
}

/// Entries whose names begin with `start`, sorted by name; empty if the folder does not exist.
std::vector<fs::path> entries_of(const fs::path& folder, std::string_view start) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename().string().starts_with(start)) entries.push_back(entry->path());
  }
  std::ranges::sort(entries);
  return entries;
}

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

namespace {

/// The last complete line of a log, and its number; 0 without one.
std::pair<std::string, std::int64_t> last_line_of(const fs::path& log) {
  std::ifstream file(log);
  std::string whole, line;
  std::int64_t number = 0;
  for (; std::getline(file, line) && !file.eof(); ++number) whole.swap(line);
  return {whole, number};
}

}  // namespace

std::vector<RailPower> read_tegrastats(const fs::path& log) {
  return parse_tegrastats(last_line_of(log).first);
}

void require_tegrastats(const fs::path& log) {
  const auto [line, number] = last_line_of(log);
  if (number == 0 || !parse_tegrastats(line).empty()) return;
  throw InputError(log.string(), static_cast<int>(number),
                   "is no line of tegrastats with the power of a rail, such as \"RAM 2448/3964MB ... VDD_IN "
                   "4060mW/4060mW\"; pass the file of `tegrastats --logfile FILE`");
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

namespace {

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
  for (const fs::path& cpu : entries_of(root / kCpuFolder, "cpu")) {
    for (const char* counter : {"core_throttle_count", "package_throttle_count"})
      state.events = with(std::move(state.events), cpu / "thermal_throttle" / counter);
  }
  for (const fs::path& policy : entries_of(root / kCpuFolder / "cpufreq", "policy"))
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

namespace {

using Json = nlohmann::ordered_json;

std::optional<std::string> governors(const fs::path& root) {
  std::set<std::string> names;
  for (const fs::path& policy : entries_of(root / kCpuFolder / "cpufreq", "policy")) {
    if (const auto name = line_in(policy / "scaling_governor")) names.insert(*name);
  }
  if (names.empty()) return line_in(root / kCpuFolder / "cpu0/cpufreq/scaling_governor");
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

std::optional<double> frequency_limit_mhz(const fs::path& root) {
  constexpr std::int64_t kLargestKhz = 100'000'000;
  std::optional<double> largest;
  for (const fs::path& policy : entries_of(root / kCpuFolder / "cpufreq", "policy")) {
    const auto limit = number_in(policy / "scaling_max_freq");
    if (limit && *limit > 0 && *limit < kLargestKhz)
      largest = std::max(largest.value_or(0.0), 1e-3 * static_cast<double>(*limit));
  }
  return largest;
}

/// The words of the line after `key`, up to the next blank or '>'.
std::string value_after(const std::string& line, const std::string& key) {
  const std::size_t begin = line.find(key);
  if (begin == std::string::npos) return "";
  const std::size_t first = begin + key.size();
  return line.substr(first, line.find_first_of(" >", first) - first);
}

/// The status file contains "pmode:0002", and nvpmodel.conf the names: "< POWER_MODEL ID=2 NAME=MODE_15W >".
std::optional<std::string> power_mode(const fs::path& root) {
  const std::optional<std::string> status = line_in(root / "var/lib/nvpmodel/status");
  if (!status || !status->starts_with("pmode:")) return std::nullopt;
  const std::optional<std::int64_t> mode = number_of(status->substr(std::string("pmode:").size()));
  if (!mode || *mode < 0) return std::nullopt;
  const std::string id = std::to_string(*mode);
  std::ifstream names(root / "etc/nvpmodel.conf");
  for (std::string line; std::getline(names, line);) {
    if (line.find("POWER_MODEL") != std::string::npos && value_after(line, "ID=") == id &&
        !value_after(line, "NAME=").empty())
      return value_after(line, "NAME=") + " (" + id + ")";
  }
  return id;
}

/// "# R35 (release), REVISION: 4.1, GCID: ...": the release of the Linux of a JetPack.
std::optional<std::string> jetpack_version(const fs::path& root) {
  struct Release {
    std::string_view l4t, jetpack;
  };
  constexpr std::array<Release, 5> kReleases = {
      {{"R32", "4"}, {"R34", "5"}, {"R35", "5"}, {"R36", "6"}, {"R38", "7"}}};
  const std::optional<std::string> line = line_in(root / "etc/nv_tegra_release");
  if (!line || !line->starts_with("# R")) return std::nullopt;
  const std::string release = value_after(*line, "# ");
  std::string revision = value_after(*line, "REVISION: ");
  if (revision.ends_with(',')) revision.pop_back();
  const std::string l4t = "L4T " + release + (revision.empty() ? "" : "." + revision);
  const auto found = std::ranges::find(kReleases, release, &Release::l4t);
  return found == kReleases.end() ? l4t : "JetPack " + std::string(found->jetpack) + " (" + l4t + ")";
}

/// Zones of units without power report -256 deg C.
std::optional<double> valid_celsius(std::optional<std::int64_t> millidegrees) {
  constexpr double kLowest = -55.0, kHighest = 150.0;
  if (!millidegrees) return std::nullopt;
  const double celsius = 1e-3 * static_cast<double>(*millidegrees);
  return celsius > kLowest && celsius < kHighest ? std::optional(celsius) : std::nullopt;
}

std::vector<ThermalZone> thermal_zones(const fs::path& root) {
  std::vector<ThermalZone> zones;
  for (const fs::path& zone : entries_of(root / "sys/class/thermal", "thermal_zone")) {
    zones.push_back({.name = line_in(zone / "type").value_or(zone.filename().string()),
                     .celsius = valid_celsius(number_in(zone / "temp"))});
  }
  return zones;
}

template <typename Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

DeviceInfo device_info(const fs::path& root) {
  std::optional<std::string> model = line_in(root / "proc/device-tree/model");
  if (!model) model = line_in(root / "sys/class/dmi/id/product_name");
  return {.model = model,
          .cores_online = line_in(root / kCpuFolder / "online"),
          .cores_present = line_in(root / kCpuFolder / "present"),
          .governor = governors(root),
          .frequency_limit_mhz = frequency_limit_mhz(root),
          .nvpmodel = power_mode(root),
          .jetpack = jetpack_version(root),
          .thermal_zones = thermal_zones(root),
          .power_rails = read_power_sensors(root),
          .energy_counters = read_rapl(root)};
}

std::optional<double> hottest_celsius(const fs::path& root) {
  std::optional<double> hottest;
  for (const ThermalZone& zone : thermal_zones(root)) {
    if (zone.celsius) hottest = std::max(hottest.value_or(*zone.celsius), *zone.celsius);
  }
  return hottest;
}

Json device_json(const DeviceInfo& device) {
  Json zones = Json::array(), rails = Json::array(), counters = Json::array();
  for (const ThermalZone& zone : device.thermal_zones)
    zones.push_back({{"name", zone.name}, {"celsius", or_null(zone.celsius)}});
  for (const RailPower& rail : device.power_rails)
    rails.push_back({{"name", rail.rail}, {"power_w", or_null(rail.power_w)}});
  for (const EnergyCounter& counter : device.energy_counters)
    counters.push_back(
        {{"name", counter.name}, {"readable", joules_between({counter}, {counter}).has_value()}});
  return {{"model", or_null(device.model)},
          {"cores_online", or_null(device.cores_online)},
          {"cores_present", or_null(device.cores_present)},
          {"governor", or_null(device.governor)},
          {"frequency_limit_mhz", or_null(device.frequency_limit_mhz)},
          {"nvpmodel", or_null(device.nvpmodel)},
          {"jetpack", or_null(device.jetpack)},
          {"thermal_zones", zones},
          {"power_rails", rails},
          {"energy_counters", counters}};
}

}  // namespace stillpoint::bench
