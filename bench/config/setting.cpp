// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/setting.h"

#include <algorithm>
#include <sstream>

#include <toml++/toml.h>

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

}  // namespace stillpoint::bench
