// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/profile/meters/device_info.h"
#include "bench/profile/meters/run_monitor.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

struct DeviceArguments {
  std::string sysfs_root = "/";
  bool json = false;
};

constexpr const char* kUnavailable = "unavailable";

void print_row(std::string_view name, const std::optional<std::string>& value) {
  std::cout << fmt::format("{:<20} {}\n", name, value.value_or(kUnavailable));
}

std::optional<std::string> with_unit(const std::optional<double>& value, std::string_view unit) {
  return value ? std::optional(fmt::format("{:.4g} {}", *value, unit)) : std::nullopt;
}

/// Why there is no energy measurement, or its source.
std::string energy_source(const DeviceInfo& device, const std::string& root) {
  const auto use = EnergyMeter(root, "", {}).so_far();
  if (use) return use->source;
  if (!device.energy_counters.empty()) return "unavailable: energy_uj is not readable, usually for root only";
  return device.power_rails.empty() ? kUnavailable : "unavailable: a power rail has no valid value";
}

void print_device(const DeviceInfo& device, const std::string& root) {
  print_row("model", device.model);
  print_row("cores online", device.cores_online);
  print_row("cores present", device.cores_present);
  print_row("governor", device.governor);
  print_row("frequency limit", with_unit(device.frequency_limit_mhz, "MHz"));
  print_row("nvpmodel", device.nvpmodel);
  print_row("JetPack", device.jetpack);
  if (device.thermal_zones.empty()) print_row("thermal zones", std::nullopt);
  for (const ThermalZone& zone : device.thermal_zones)
    print_row("zone " + zone.name, with_unit(zone.celsius, "deg C"));
  if (device.power_rails.empty()) print_row("power rails", std::nullopt);
  for (const RailPower& rail : device.power_rails)
    print_row("rail " + rail.rail, with_unit(rail.power_w, "W"));
  print_row("energy of runs", energy_source(device, root));
}

int show_device(const DeviceArguments& arguments) {
  if (!std::filesystem::is_directory(arguments.sysfs_root))
    throw InputError(arguments.sysfs_root, "is not a folder; give one that contains sys, proc and etc");
  const DeviceInfo device = device_info(arguments.sysfs_root);
  if (arguments.json) {
    nlohmann::ordered_json json = {{"schema", 1}};
    json.update(device_json(device));
    std::cout << json.dump(2) << '\n';
  } else {
    print_device(device, arguments.sysfs_root);
  }
  return kExitOk;
}

Command device_info_command() {
  const auto arguments = std::make_shared<DeviceArguments>();
  return {.name = "info",
          .summary = "Show cores, frequency governor, power mode, temperatures and power rails",
          .example = "device info",
          .options = {{"--sysfs-root", kSysfsRootHelp, &arguments->sysfs_root},
                      {"--json", "Print JSON", &arguments->json}},
          .action = [arguments] { return show_device(*arguments); }};
}

}  // namespace

Command device_command() {
  return {.name = "device",
          .summary = "Inspect this machine",
          .example = "device info",
          .subcommands = {device_info_command()}};
}

}  // namespace stillpoint::bench
