// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/settings.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "bench/config/spelling.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

std::string type_name(const toml::node& node) {
  std::ostringstream name;
  name << node.type();
  return name.str();
}

/// Converts the TOML nodes of one file.
struct SettingReader {
  std::string file;  ///< for error messages

  [[nodiscard]] InputError unsupported(const std::string& key, const toml::node& node) const {
    return {file, static_cast<long>(node.source().begin.line),
            "\"" + key + "\" has the unsupported type " + type_name(node) +
                "; use true or false, a number, a string, or a list of strings or of numbers"};
  }

  [[nodiscard]] std::vector<std::string> strings_of(const std::string& key, const toml::array& array) const {
    std::vector<std::string> strings;
    for (const toml::node& element : array) {
      if (!element.is_string()) throw unsupported(key, element);
      strings.push_back(element.as_string()->get());
    }
    return strings;
  }

  [[nodiscard]] std::vector<double> numbers_of(const std::string& key, const toml::array& array) const {
    std::vector<double> numbers;
    for (const toml::node& element : array) {
      if (!element.is_number()) throw unsupported(key, element);
      numbers.push_back(element.value<double>().value());
    }
    return numbers;
  }

  [[nodiscard]] SettingValue value_of(const std::string& key, const toml::node& node) const {
    if (const auto* boolean = node.as_boolean()) return boolean->get();
    if (const auto* integer = node.as_integer()) return integer->get();
    if (const auto* number = node.as_floating_point()) return number->get();
    if (const auto* text = node.as_string()) return text->get();
    const auto* array = node.as_array();
    if (array != nullptr && !array->empty() && array->front().is_number()) return numbers_of(key, *array);
    if (array != nullptr) return strings_of(key, *array);
    throw unsupported(key, node);
  }

  [[nodiscard]] std::vector<Setting> settings_of(const std::string& prefix, const toml::table& table) const {
    std::vector<Setting> settings;
    for (const auto& [name, node] : table) {
      const std::string key = prefix + std::string(name.str());
      if (const auto* inner = node.as_table()) {
        const std::vector<Setting> nested = settings_of(key + ".", *inner);
        settings.insert(settings.end(), nested.begin(), nested.end());
      } else {
        settings.push_back({key, value_of(key, node), file, static_cast<long>(node.source().begin.line)});
      }
    }
    return settings;
  }
};

bool is_toml(const std::string& text) {
  try {
    return toml::parse(text).size() == 1;
  } catch (const toml::parse_error&) {
    return false;
  }
}

}  // namespace

std::vector<Setting> parse_settings(std::string_view text, const std::string& file) {
  try {
    const toml::table table = toml::parse(text, file);
    std::vector<Setting> settings = SettingReader{file}.settings_of("", table);
    std::stable_sort(settings.begin(), settings.end(),
                     [](const Setting& a, const Setting& b) { return a.line < b.line; });
    return settings;
  } catch (const toml::parse_error& error) {
    throw InputError(file, static_cast<long>(error.source().begin.line),
                     "invalid TOML: " + std::string(error.description()));
  }
}

Setting parse_assignment(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("--set", "\"" + assignment + "\" is not an assignment; write key=value");
  }
  const std::string key = assignment.substr(0, equals);
  const std::string value = assignment.substr(equals + 1);
  const std::string as_string = key + " = '" + value + "'";
  const std::vector<Setting> settings = parse_settings(is_toml(assignment) ? assignment : as_string, "--set");
  if (settings.size() != 1) throw InputError("--set", "\"" + assignment + "\" must set exactly one key");
  Setting setting = settings.front();
  setting.line = 0;
  return setting;
}

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

double number_within(double value, const Setting& setting, const FieldInfo& bounds) {
  if (value >= bounds.min && value <= bounds.max) return value;  // false for NaN
  throw bad_value(setting, fmt::format("is {}, out of range; it must be between {} and {}", value, bounds.min,
                                       bounds.max));
}

/// Assigns the value of a setting to the member of a field.
struct Assign {
  const Setting& setting;
  const FieldInfo& bounds;

  void operator()(bool* member) const { *member = value_as<bool>(setting, "true or false"); }

  void operator()(int* member) const {
    const std::int64_t value = value_as<std::int64_t>(setting, "an integer");
    const FieldInfo representable =
        field_info(std::max(bounds.min, -2147483648.0), std::min(bounds.max, 2147483647.0));
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
    std::visit(Assign{setting, field->info}, field->member);
  }
}

}  // namespace stillpoint::bench
