// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/energy_files.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// First word of a file in /sys; nothing if it is not readable.
std::optional<std::string> word_in(const fs::path& file) {
  std::ifstream stream(file);
  std::string word;
  return stream >> word ? std::optional(word) : std::nullopt;
}

std::optional<std::int64_t> number_of(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> number_in(const fs::path& file) {
  const std::optional<std::string> word = word_in(file);
  return word ? number_of(*word) : std::nullopt;
}

/// Sorted by name; empty if the folder does not exist.
std::vector<fs::path> entries_of(const fs::path& folder, std::string_view start) {
  std::vector<fs::path> entries;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().filename().string().starts_with(start)) entries.push_back(entry.path());
  }
  std::ranges::sort(entries);
  return entries;
}

/// hwmon channels ("in1_label") are numbered from 1, iio channels ("rail_name_0") from 0.
constexpr int kMaxChannels = 8;

std::vector<RailPower> hwmon_rails(const fs::path& folder) {
  std::vector<RailPower> rails;
  for (int i = 1; i <= kMaxChannels; ++i) {
    const std::string number = std::to_string(i);
    const auto name = word_in(folder / ("in" + number + "_label"));
    const auto millivolts = number_in(folder / ("in" + number + "_input"));
    const auto milliamperes = number_in(folder / ("curr" + number + "_input"));
    if (!name || !millivolts || !milliamperes) continue;
    rails.push_back({*name, 1e-6 * static_cast<double>(*millivolts) * static_cast<double>(*milliamperes)});
  }
  return rails;
}

std::vector<RailPower> iio_rails(const fs::path& folder) {
  std::vector<RailPower> rails;
  for (int i = 0; i < kMaxChannels; ++i) {
    const std::string number = std::to_string(i);
    const auto name = word_in(folder / ("rail_name_" + number));
    const auto milliwatts = number_in(folder / ("in_power" + number + "_input"));
    if (name && milliwatts) rails.push_back({*name, 1e-3 * static_cast<double>(*milliwatts)});
  }
  return rails;
}

/// "4060/4060" or "4060mW/4060mW"; memory usage ("2457/15823MB") is not accepted.
std::optional<double> current_power_w(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto without_unit = [](std::string_view part) {
    return part.ends_with("mW") ? part.substr(0, part.size() - 2) : part;
  };
  const auto now = number_of(without_unit(text.substr(0, slash)));
  const auto mean = number_of(without_unit(text.substr(slash + 1)));
  if (!now || !mean) return std::nullopt;
  return 1e-3 * static_cast<double>(*now);
}

}  // namespace

std::vector<EnergyCounter> read_rapl(const fs::path& root) {
  std::vector<EnergyCounter> counters;
  for (const fs::path& zone : entries_of(root / "sys/class/powercap", "intel-rapl:")) {
    const std::string name = zone.filename().string();
    if (std::ranges::count(name, ':') != 1) continue;  // "intel-rapl:0:1" is a subzone of "intel-rapl:0"
    const auto energy = number_in(zone / "energy_uj");
    if (!energy) continue;
    counters.push_back({.name = word_in(zone / "name").value_or(name),
                        .energy_uj = *energy,
                        .range_uj = number_in(zone / "max_energy_range_uj").value_or(0)});
  }
  return counters;
}

double joules_between(const std::vector<EnergyCounter>& before, const std::vector<EnergyCounter>& after) {
  std::int64_t sum_uj = 0;
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    const std::int64_t spent = after[i].energy_uj - before[i].energy_uj;
    sum_uj += spent >= 0 ? spent : spent + after[i].range_uj;
  }
  return 1e-6 * static_cast<double>(sum_uj);
}

std::vector<RailPower> read_ina3221(const fs::path& root) {
  std::vector<RailPower> rails;
  const auto add = [&](const std::vector<RailPower>& more) {
    rails.insert(rails.end(), more.begin(), more.end());
  };
  for (const char* name : {"ina3221", "ina3221x"}) {
    for (const fs::path& device : entries_of(root / "sys/bus/i2c/drivers" / name, "")) {
      for (const fs::path& folder : entries_of(device / "hwmon", "hwmon")) add(hwmon_rails(folder));
      for (const fs::path& folder : entries_of(device, "iio:device")) add(iio_rails(folder));
    }
  }
  return rails;
}

std::vector<RailPower> parse_tegrastats(std::string_view line) {
  std::vector<RailPower> rails;
  std::istringstream words{std::string(line)};
  std::string name;
  for (std::string word; words >> word; name = word) {
    if (const std::optional<double> power_w = current_power_w(word)) rails.push_back({name, *power_w});
  }
  return rails;
}

std::vector<RailPower> read_tegrastats(const fs::path& log) {
  std::ifstream file(log);
  std::string whole, line;
  while (std::getline(file, line) && !file.eof()) whole.swap(line);
  return parse_tegrastats(whole);
}

double device_power_w(const std::vector<RailPower>& rails) {
  double sum = 0.0;
  for (const RailPower& rail : rails) {
    if (rail.rail == "VDD_IN" || rail.rail == "POM_5V_IN") return rail.power_w;
    sum += rail.power_w;
  }
  return sum;
}

}  // namespace stillpoint::bench
