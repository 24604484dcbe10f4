// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_file.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <sstream>

#include "bench/config/apply_settings.h"
#include "bench/config/toml_source.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kRootConfig = "bench/configs/dynamic_vins.toml";

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
  const std::vector<Setting> settings = parse_settings(source.text, source.path);
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

}  // namespace

OdometryConfig load_config(const ConfigRequest& request) {
  std::vector<ConfigChain> chains = variant_chains(request.variant);
  const bool variant_has_base = !chains.empty() && chains.front().is_base();
  if (!variant_has_base) chains.insert(chains.begin(), load_chain(request.base));

  OdometryConfig config;
  for (const ConfigChain& chain : chains) config = with_settings(config, chain.settings);
  for (const std::string& assignment : request.settings) {
    config = with_settings(config, std::vector{parse_assignment(assignment)});
  }
  return config;
}

}  // namespace stillpoint::bench
