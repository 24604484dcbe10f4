// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/apply_settings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/spelling.h"
#include "core/base/error.h"

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

/// Assigns the value of a setting to the member of a field.
struct Assign {
  const Setting& setting;
  const Bounds& bounds;

  void operator()(bool* member) const { *member = value_as<bool>(setting, "true or false"); }

  void operator()(int* member) const {
    const std::int64_t value = value_as<std::int64_t>(setting, "an integer");
    const Bounds representable{std::max(bounds.min, -2147483648.0), std::min(bounds.max, 2147483647.0)};
    *member = static_cast<int>(number_within(static_cast<double>(value), setting, representable));
  }

  void operator()(double* member) const {
    const auto* whole = std::get_if<std::int64_t>(&setting.value);
    const double value = whole ? static_cast<double>(*whole) : value_as<double>(setting, "a number");
    *member = number_within(value, setting, bounds);
  }

  void operator()(std::string* member) const { *member = value_as<std::string>(setting, "a string"); }

  void operator()(std::vector<std::string>* member) const {
    *member = value_as<std::vector<std::string>>(setting, "a list of strings");
  }

  void operator()(std::vector<int>* member) const {
    member->clear();
    const auto* texts = std::get_if<std::vector<std::string>>(&setting.value);
    if (texts != nullptr && texts->empty()) return;  // [] has no type
    for (const double number : value_as<std::vector<double>>(setting, "a list of integers")) {
      if (number != std::floor(number)) throw bad_value(setting, "must be a list of integers");
      member->push_back(static_cast<int>(number_within(number, setting, bounds)));
    }
  }

  void operator()(const EnumField& field) const {
    const std::string choices = fmt::format("\"{}\"", fmt::join(field.names, "\", \""));
    const std::string text = value_as<std::string>(setting, "one of " + choices);
    const auto found = std::find(field.names.begin(), field.names.end(), text);
    if (found == field.names.end()) {
      throw bad_value(setting, fmt::format("is \"{}\"; expected one of: {}", text, choices));
    }
    field.set(field.member, static_cast<std::size_t>(found - field.names.begin()));
  }
};

InputError unknown_key(const Setting& setting, std::span<const ConfigField> fields) {
  std::vector<std::string> keys;
  for (const ConfigField& field : fields) keys.push_back(field.key);
  const bool is_section = std::any_of(
      keys.begin(), keys.end(), [&](const std::string& key) { return key.starts_with(setting.key + "."); });
  if (is_section)
    return bad_value(setting, "is a section, not a key; write [" + setting.key + "] followed by its keys");
  return error_at(setting, fmt::format("unknown key \"{}\"{}", setting.key, suggestion(setting.key, keys)));
}

}  // namespace

void assign_settings(std::span<const ConfigField> fields, std::span<const Setting> settings) {
  for (const Setting& setting : settings) {
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const ConfigField& candidate) {
      return candidate.key == setting.key;
    });
    if (field == fields.end()) throw unknown_key(setting, fields);
    std::visit(Assign{setting, field->bounds}, field->member);
  }
}

}  // namespace stillpoint::bench
