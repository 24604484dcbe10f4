// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/device_info.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "bench/profile/meters/sysfs_values.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const char* const kCpuFolder = "sys/devices/system/cpu";

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
