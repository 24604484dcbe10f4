// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "bench/cli/command_line.h"
#include "bench/config/config_file.h"
#include "bench/config/toml_source.h"

namespace stillpoint::bench {
namespace {

int show(const ConfigRequest& request) {
  const OdometryConfig config = load_config(request);
  std::cout << "# hash " << config_hash(config) << '\n' << config_text(config);
  return kExitOk;
}

int list() {
  for (const std::string& name : embedded_names(TomlKind::kConfig)) std::cout << name << '\n';
  return kExitOk;
}

int reference() {
  std::cout << config_reference();
  return kExitOk;
}

}  // namespace

Command config_command() {
  const auto request = std::make_shared<ConfigRequest>();
  Command show_config{
      .name = "show",
      .summary = "Print all keys of a config after inheritance, overlays and overrides",
      .example = "config show --config dynamic_vins --variant vo",
      .options = {{"--config", "Base config: an embedded name or a TOML file", &request->base},
                  {"--variant", "Overlays joined by +", &request->variant},
                  {"--set", "Override a config key: key=value; may be repeated", &request->settings}},
      .action = [request] { return show(*request); }};
  Command list_configs{.name = "list",
                       .summary = "Print the names of the embedded configs and overlays",
                       .example = "config list",
                       .action = list};
  Command print_reference{.name = "reference",
                          .summary = "Print a reference of all keys (Markdown)",
                          .example = "config reference",
                          .action = reference};
  return {.name = "config",
          .summary = "Show configs and their keys",
          .example = "config show",
          .subcommands = {std::move(show_config), std::move(list_configs), std::move(print_reference)}};
}

}  // namespace stillpoint::bench
