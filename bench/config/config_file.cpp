// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_file.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <span>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/config_keys.h"
#include "bench/config/key_effects.h"
#include "bench/config/settings.h"
#include "bench/config/toml_source.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kRootConfig = "bench/configs/stillpoint.toml";

/// A config file with all files that it inherits, the root first.
struct ConfigChain {
  std::vector<std::string> paths;
  std::vector<Setting> settings;
  [[nodiscard]] bool is_base() const { return paths.front() == kRootConfig; }
};

/// The key `inherits` of a file, if any.
std::optional<Setting> find_inherits(const std::vector<Setting>& settings) {
  const auto found = std::find_if(settings.begin(), settings.end(),
                                  [](const Setting& setting) { return setting.key == "inherits"; });
  if (found == settings.end()) return std::nullopt;
  if (!std::holds_alternative<std::string>(found->value)) {
    throw InputError(found->file, found->line, "\"inherits\" must be a string, the name of one config");
  }
  return *found;
}

/// @param visited paths of the files that inherit this one, directly or indirectly
ConfigChain load_chain(const TomlSource& source, std::vector<std::string> visited) {
  std::vector<Setting> settings = parse_settings(source.text, source.path);
  for (Setting& setting : settings) setting.shipped = source.embedded;
  const std::optional<Setting> inherits = find_inherits(settings);
  visited.push_back(source.path);
  ConfigChain chain;
  if (inherits) {
    const TomlSource parent = find_parent(source, std::get<std::string>(inherits->value));
    if (std::find(visited.begin(), visited.end(), parent.path) != visited.end()) {
      throw InputError(inherits->file, inherits->line,
                       "circular inheritance through \"" + parent.path + "\"; remove one \"inherits\"");
    }
    chain = load_chain(parent, visited);
  }
  chain.paths.push_back(source.path);
  std::copy_if(settings.begin(), settings.end(), std::back_inserter(chain.settings),
               [](const Setting& setting) { return setting.key != "inherits"; });
  return chain;
}

ConfigChain load_chain(const std::string& name) { return load_chain(find_toml(name, TomlKind::kConfig), {}); }

std::vector<ConfigChain> variant_chains(const std::string& variant) {
  std::vector<ConfigChain> chains;
  std::istringstream names(variant);
  for (std::string name; std::getline(names, name, '+');) chains.push_back(load_chain(name));
  // The base is applied first, wherever it is in the name.
  std::stable_partition(chains.begin(), chains.end(),
                        [](const ConfigChain& chain) { return chain.is_base(); });
  if (chains.size() > 1 && chains[1].is_base()) {
    throw InputError("variant \"" + variant + "\"",
                     "contains two base configs; combine one base with overlays");
  }
  return chains;
}

/// All settings of a request in the order in which they are applied.
std::vector<Setting> settings_of(const ConfigRequest& request) {
  std::vector<ConfigChain> chains = variant_chains(request.variant);
  const bool variant_has_base = !chains.empty() && chains.front().is_base();
  if (!variant_has_base) chains.insert(chains.begin(), load_chain(request.base));
  std::vector<Setting> settings;
  for (const ConfigChain& chain : chains)
    settings.insert(settings.end(), chain.settings.begin(), chain.settings.end());
  for (const std::string& assignment : request.settings) settings.push_back(parse_assignment(assignment));
  return settings;
}

std::string place_of(const Setting& setting) {
  return setting.line > 0 ? fmt::format("{}:{}", setting.file, setting.line) : setting.file;
}

}  // namespace

OdometryConfig load_config(const ConfigRequest& request) {
  return with_settings(OdometryConfig{}, settings_of(request));
}

std::vector<std::string> settings_without_effect(const ConfigRequest& request) {
  const std::vector<Setting> settings = settings_of(request);
  std::vector<Setting> shipped;
  std::ranges::copy_if(settings, std::back_inserter(shipped), &Setting::shipped);
  const OdometryConfig config = with_settings(OdometryConfig{}, settings);
  const std::vector<ConfigEntry> changed =
      config_difference(with_settings(OdometryConfig{}, shipped), config);
  std::vector<std::string> messages;
  for (const Setting& setting : settings) {
    if (setting.shipped || std::ranges::find(changed, setting.key, &ConfigEntry::key) == changed.end())
      continue;
    const std::string_view requirement = missing_requirement(setting.key, config);
    if (requirement.empty()) continue;
    messages.push_back(
        fmt::format("{}: \"{}\" has no effect; it requires {}", place_of(setting), setting.key, requirement));
  }
  return messages;
}

std::vector<std::string> files_of_config(const std::string& file) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  std::optional<TomlSource> source = find_toml(file, TomlKind::kConfig);
  static_cast<void>(load_chain(*source, {}));  // rejects circular inheritance
  while (source && !source->embedded) {
    files.push_back(fs::absolute(source->path).lexically_normal().string());
    const std::optional<Setting> inherits = find_inherits(parse_settings(source->text, source->path));
    if (!inherits) break;
    source = find_parent(*source, std::get<std::string>(inherits->value));
  }
  return files;
}

std::string toml_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += letter;
  }
  return result + '"';
}

namespace {

std::string quoted_list(std::span<const std::string_view> texts) {
  std::vector<std::string> elements;
  for (const std::string_view text : texts) elements.push_back(toml_quoted(text));
  return fmt::format("{}", fmt::join(elements, ", "));
}

/// Formats the value of a field in TOML syntax.
struct TomlValue {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const int* value) const { return std::to_string(*value); }
  std::string operator()(const std::string* value) const { return toml_quoted(*value); }
  std::string operator()(const EnumField& field) const {
    return toml_quoted(field.names[field.get(field.member)]);
  }

  std::string operator()(const double* value) const {
    const std::string shortest = fmt::format("{}", *value);
    const bool looks_whole = shortest.find_first_of(".en") == std::string::npos;
    return looks_whole ? shortest + ".0" : shortest;
  }

  std::string operator()(const std::vector<std::string>* values) const {
    return fmt::format("[{}]", quoted_list(std::vector<std::string_view>(values->begin(), values->end())));
  }

  std::string operator()(const std::vector<int>* values) const {
    return fmt::format("[{}]", fmt::join(*values, ", "));
  }
};

/// Describes the type of a field, or its choices, for the reference page.
struct TypeText {
  std::string operator()(const bool*) const { return "true or false"; }
  std::string operator()(const int*) const { return "integer"; }
  std::string operator()(const double*) const { return "number"; }
  std::string operator()(const std::string*) const { return "string"; }
  std::string operator()(const std::vector<std::string>*) const { return "list of strings"; }
  std::string operator()(const std::vector<int>*) const { return "list of integers"; }
  std::string operator()(const EnumField& field) const { return quoted_list(field.names); }
};

/// The values that a number accepts, with its unit.
std::string range_text(const KeyReference& key) {
  const std::string range = key.min ? fmt::format("{} to {}", *key.min, *key.max) : "";
  return key.unit.empty() ? range : fmt::format("{} {}", range, key.unit);
}

}  // namespace

std::vector<ConfigEntry> config_entries(const OdometryConfig& config) {
  std::vector<ConfigEntry> entries;
  OdometryConfig copy = config;
  for (const ConfigField& field : fields_of(copy)) {
    entries.push_back({field.key, std::visit(TomlValue{}, field.member)});
  }
  return entries;
}

std::string config_text(const OdometryConfig& config) {
  std::string text;
  for (const auto& [key, value] : config_entries(config)) text += fmt::format("{} = {}\n", key, value);
  return text;
}

std::vector<DifferentKey> different_keys(const OdometryConfig& a, const OdometryConfig& b) {
  OdometryConfig copy_a = a;
  OdometryConfig copy_b = b;
  return different_keys(fields_of(copy_a), fields_of(copy_b));
}

std::vector<DifferentKey> different_keys(std::span<const ConfigField> a, std::span<const ConfigField> b) {
  std::vector<DifferentKey> keys;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::string value_a = std::visit(TomlValue{}, a[i].member);
    const std::string value_b = std::visit(TomlValue{}, b[i].member);
    if (value_a != value_b) keys.push_back({a[i].key, value_a, value_b, std::string(a[i].info.unit)});
  }
  return keys;
}

std::string difference_text(std::span<const DifferentKey> keys) {
  std::string text;
  for (const auto& [key, value_a, value_b, unit] : keys)
    text += fmt::format("{} = {} -> {}{}{}\n", key, value_a, value_b, unit.empty() ? "" : " ", unit);
  return text;
}

std::vector<ConfigEntry> config_difference(const OdometryConfig& parent, const OdometryConfig& changed) {
  const std::vector<ConfigEntry> before = config_entries(parent);
  const std::vector<ConfigEntry> after = config_entries(changed);
  std::vector<ConfigEntry> difference;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after[i] != before[i]) difference.push_back(after[i]);
  }
  return difference;
}

std::vector<KeyReference> key_references() {
  std::vector<KeyReference> keys;
  OdometryConfig defaults;
  for (const ConfigField& field : fields_of(defaults)) {
    const FieldInfo& info = field.info;
    const bool bounded = info.min > -std::numeric_limits<double>::infinity();
    keys.push_back({.key = field.key,
                    .meaning = std::string(info.text),
                    .type = std::visit(TypeText{}, field.member),
                    .min = bounded ? std::optional(info.min) : std::nullopt,
                    .max = bounded ? std::optional(info.max) : std::nullopt,
                    .unit = std::string(info.unit),
                    .default_value = std::visit(TomlValue{}, field.member),
                    .paper = std::string(info.paper)});
  }
  return keys;
}

std::string config_reference() {
  std::string page = "# Configuration keys\n\nGenerated by `stillpoint config reference`. ";
  page += "Paper: section of the paper that describes it; empty: not in the paper.\n\n";
  page += "| key | meaning | type | range | default | paper |\n|---|---|---|---|---|---|\n";
  for (const KeyReference& key : key_references()) {
    page += fmt::format("| `{}` | {} | {} | {} | `{}` | {} |\n", key.key, key.meaning, key.type,
                        range_text(key), key.default_value, key.paper);
  }
  return page;
}

}  // namespace stillpoint::bench
