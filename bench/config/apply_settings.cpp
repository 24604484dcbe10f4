// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/apply_settings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/config/field_walk.h"
#include "bench/config/spelling.h"
#include "bench/plan/bench_plan.h"
#include "bench/profile/device_file.h"
#include "bench/systems/external_system.h"
#include "core/base/error.h"
#include "core/config/odometry_config.h"

namespace stillpoint::bench {
namespace {

InputError error_at(const Setting& setting, const std::string& problem) {
  return setting.line > 0 ? InputError(setting.file, setting.line, problem)
                          : InputError(setting.file, problem);
}

InputError bad_value(const Setting& setting, const std::string& problem) {
  return error_at(setting, fmt::format("\"{}\" {}", setting.key, problem));
}

template <class T>
T value_as(const Setting& setting, const std::string& type) {
  if (const T* value = std::get_if<T>(&setting.value)) return *value;
  throw bad_value(setting, "has the wrong type; it must be " + type);
}

double number_within(double value, const Setting& setting, const Bounds& bounds) {
  if (value >= bounds.min && value <= bounds.max) return value;  // false for NaN
  throw bad_value(setting, fmt::format("is {}, out of range; it must be between {} and {}", value, bounds.min,
                                       bounds.max));
}

/// Assigns the value of a setting to a member of any supported type.
struct Assign {
  const Setting& setting;
  const Bounds& bounds;

  void operator()(bool& member) const { member = value_as<bool>(setting, "true or false"); }

  void operator()(int& member) const {
    const std::int64_t value = value_as<std::int64_t>(setting, "an integer");
    const Bounds representable{std::max(bounds.min, -2147483648.0), std::min(bounds.max, 2147483647.0)};
    member = static_cast<int>(number_within(static_cast<double>(value), setting, representable));
  }

  void operator()(double& member) const {
    const auto* whole = std::get_if<std::int64_t>(&setting.value);
    const double value = whole ? static_cast<double>(*whole) : value_as<double>(setting, "a number");
    member = number_within(value, setting, bounds);
  }

  void operator()(std::string& member) const { member = value_as<std::string>(setting, "a string"); }

  void operator()(std::vector<std::string>& member) const {
    member = value_as<std::vector<std::string>>(setting, "a list of strings");
  }

  void operator()(std::vector<int>& member) const {
    member.clear();
    for (const double number : value_as<std::vector<double>>(setting, "a list of integers")) {
      if (number != std::floor(number)) throw bad_value(setting, "must be a list of integers");
      member.push_back(static_cast<int>(number_within(number, setting, bounds)));
    }
  }

  template <ConfigEnum Enum>
  void operator()(Enum& member) const {
    std::string choices;
    for (const auto& [value, name] : enum_names(Enum{})) {
      choices += fmt::format("{}\"{}\"", choices.empty() ? "" : ", ", name);
    }
    const std::string text = value_as<std::string>(setting, "one of " + choices);
    for (const auto& [value, name] : enum_names(Enum{})) {
      if (name == text) {
        member = value;
        return;
      }
    }
    throw bad_value(setting, fmt::format("is \"{}\"; expected one of: {}", text, choices));
  }
};

template <class Config>
std::vector<std::string> all_keys(const Config& config) {
  std::vector<std::string> keys;
  walk_fields(config, [&](const std::string& key, const auto&, const Bounds&) { keys.push_back(key); });
  return keys;
}

InputError unknown_key(const Setting& setting, const std::vector<std::string>& keys) {
  const bool is_section = std::any_of(
      keys.begin(), keys.end(), [&](const std::string& key) { return key.starts_with(setting.key + "."); });
  if (is_section)
    return bad_value(setting, "is a section, not a key; write [" + setting.key + "] followed by its keys");
  return error_at(setting, fmt::format("unknown key \"{}\"{}", setting.key, suggestion(setting.key, keys)));
}

}  // namespace

template <class Config>
Config with_settings(Config config, std::span<const Setting> settings) {
  for (const Setting& setting : settings) {
    bool found = false;
    walk_fields(config, [&](const std::string& key, auto& member, const Bounds& bounds) {
      if (key != setting.key) return;
      Assign{setting, bounds}(member);
      found = true;
    });
    if (!found) throw unknown_key(setting, all_keys(config));
  }
  return config;
}

template OdometryConfig with_settings(OdometryConfig config, std::span<const Setting> settings);
template BenchPlan with_settings(BenchPlan config, std::span<const Setting> settings);
template ExternalSystem with_settings(ExternalSystem config, std::span<const Setting> settings);
template DeviceFile with_settings(DeviceFile config, std::span<const Setting> settings);

}  // namespace stillpoint::bench
