// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <vector>

#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/config/config_file.h"
#include "bench/config/config_hash.h"
#include "bench/config/config_keys.h"
#include "bench/config/toml_source.h"
#include "bench/systems/external_system.h"
#include "core/base/error.h"
#include "reports/tables/data_table.h"

namespace stillpoint::bench {
namespace {

int show(const ConfigRequest& request) {
  const OdometryConfig config = load_config(request);
  for (const std::string& message : settings_without_effect(request)) spdlog::warn("{}", message);
  std::cout << "# hash " << config_hash(config) << '\n' << config_text(config);
  return kExitOk;
}

int list_configs(bool json) {
  if (json) {
    report::DataTable table{.kind = "config_list", .columns = {"name"}, .rows = {}, .notes = {}};
    for (const std::string& name : embedded_names(TomlKind::kConfig)) table.rows.push_back({name});
    std::cout << report::data_json(table);
    return kExitOk;
  }
  for (const std::string& name : embedded_names(TomlKind::kConfig)) std::cout << name << '\n';
  return kExitOk;
}

/// The operands of `config diff`: variants of the default base, or descriptions of systems.
struct DiffArguments {
  std::string a, b;
  bool json = false;
};

/// @throws InputError if only one of the operands is a description, and for the faults of both
std::vector<DifferentKey> keys_of(const DiffArguments& arguments) {
  const bool is_system = is_description(arguments.a);
  if (is_system != is_description(arguments.b))
    throw InputError(is_system ? arguments.b : arguments.a,
                     "is no description of a system, the other operand is one; name two of a kind");
  if (is_system) return different_keys(load_external_system(arguments.a), load_external_system(arguments.b));
  const auto load = [](const std::string& variant) {
    return load_config({.base = "stillpoint", .variant = variant, .settings = {}});
  };
  return different_keys(load(arguments.a), load(arguments.b));
}

int diff(const DiffArguments& arguments) {
  const std::vector<DifferentKey> keys = keys_of(arguments);
  if (!arguments.json) {
    std::cout << difference_text(keys);
    return kExitOk;
  }
  report::DataTable table{
      .kind = "config_diff", .columns = {"key", "a", "b", "unit"}, .rows = {}, .notes = {}};
  for (const auto& [key, a, b, unit] : keys) table.rows.push_back({key, a, b, report::data_value(unit)});
  std::cout << report::data_json(table);
  return kExitOk;
}

Command diff_command() {
  const auto arguments = std::make_shared<DiffArguments>();
  return {.name = "diff",
          .summary =
              "Print the keys that differ between two configs, or two descriptions of systems, with both "
              "values and the unit",
          .example = "config diff stillpoint dynamic_vins+vo",
          .options = {{"A", "Embedded name or TOML file, with overlays or parameter sets joined by +",
                       &arguments->a},
                      {"B", "The same, of the other one", &arguments->b},
                      {"--json", report::kJsonHelp, &arguments->json}},
          .action = [arguments] { return diff(*arguments); }};
}

int reference(bool json) {
  if (!json) {
    std::cout << config_reference();
    return kExitOk;
  }
  using report::data_value;
  report::DataTable table{.kind = "config_reference",
                          .columns = {"key", "meaning", "type", "min", "max", "unit", "default", "paper"},
                          .rows = {},
                          .notes = {}};
  for (const KeyReference& key : key_references())
    table.rows.push_back({key.key, key.meaning, key.type, data_value(key.min), data_value(key.max),
                          data_value(key.unit), key.default_value, data_value(key.paper)});
  std::cout << report::data_json(table);
  return kExitOk;
}

}  // namespace

Command config_command() {
  const auto request = std::make_shared<ConfigRequest>();
  const auto json = std::make_shared<bool>(false);
  Command show_config{
      .name = "show",
      .summary = "Print all keys of a config after inheritance, overlays and overrides",
      .example = "config show --config dynamic_vins --variant vo",
      .options = {{"--config", "Base config: an embedded name or a TOML file", &request->base},
                  {"--variant", "Overlays joined by +", &request->variant},
                  {"--set", "Override a config key: key=value; may be repeated", &request->settings}},
      .action = [request] { return show(*request); }};
  Command listing{.name = "list",
                  .summary = "Print the names of the embedded configs and overlays",
                  .example = "config list",
                  .options = {{"--json", report::kJsonHelp, json.get()}},
                  .action = [json] { return list_configs(*json); }};
  Command print_reference{.name = "reference",
                          .summary =
                              "Explain all keys: meaning, unit, range, default, section of the paper "
                              "(Markdown)",
                          .example = "config reference",
                          .options = {{"--json", report::kJsonHelp, json.get()}},
                          .action = [json] { return reference(*json); }};
  return {.name = "config",
          .summary = "Show, compare and explain configs and their keys",
          .example = "config show",
          .subcommands = {std::move(show_config), std::move(listing), diff_command(),
                          std::move(print_reference)}};
}

}  // namespace stillpoint::bench
