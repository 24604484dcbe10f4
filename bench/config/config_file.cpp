// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_file.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "bench/config/apply_settings.h"
#include "bench/config/toml_source.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::string_view kRootConfig = "bench/configs/dynamic_vins.toml";

/// A file with everything that it inherits, the eldest first.
struct ConfigChain {
  std::vector<std::string> places;
  std::vector<Setting> settings;
  [[nodiscard]] bool is_base() const { return places.front() == kRootConfig; }
};

/// Takes the key `inherits` out of the settings.
std::optional<Setting> take_inherits(std::vector<Setting>& settings) {
  const auto found = std::find_if(settings.begin(), settings.end(),
                                  [](const Setting& setting) { return setting.key == "inherits"; });
  if (found == settings.end()) return std::nullopt;
  const Setting inherits = *found;
  settings.erase(found);
  if (!std::holds_alternative<std::string>(inherits.value)) {
    throw InputError(inherits.file, inherits.line, "\"inherits\" must be a string; name one config");
  }
  return inherits;
}

ConfigChain chain_of(const TomlSource& source, std::vector<std::string> heirs) {
  std::vector<Setting> settings = parse_settings(source.text, source.place);
  const std::optional<Setting> inherits = take_inherits(settings);
  heirs.push_back(source.place);
  ConfigChain chain;
  if (inherits) {
    const TomlSource parent = find_parent(source, std::get<std::string>(inherits->value));
    if (std::find(heirs.begin(), heirs.end(), parent.place) != heirs.end()) {
      throw InputError(inherits->file, inherits->line,
                       "inherits itself through \"" + parent.place + "\"; break the circle");
    }
    chain = chain_of(parent, heirs);
  }
  chain.places.push_back(source.place);
  chain.settings.insert(chain.settings.end(), settings.begin(), settings.end());
  return chain;
}

ConfigChain chain_named(const std::string& name) {
  return chain_of(find_toml(name, TomlFamily::kConfig), {});
}

std::vector<ConfigChain> variant_chains(const std::string& variant) {
  std::vector<ConfigChain> chains;
  std::istringstream names(variant);
  for (std::string name; std::getline(names, name, '+');) chains.push_back(chain_named(name));
  // The base goes first, whatever its place in the name.
  std::stable_partition(chains.begin(), chains.end(),
                        [](const ConfigChain& chain) { return chain.is_base(); });
  if (chains.size() > 1 && chains[1].is_base()) {
    throw InputError("variant \"" + variant + "\"", "names two base configs; combine one base with overlays");
  }
  return chains;
}

}  // namespace

OdometryConfig load_config(const ConfigRequest& request) {
  std::vector<ConfigChain> chains = variant_chains(request.variant);
  const bool variant_has_base = !chains.empty() && chains.front().is_base();
  if (!variant_has_base) chains.insert(chains.begin(), chain_named(request.base));

  OdometryConfig config;
  for (const ConfigChain& chain : chains) config = with_settings(config, chain.settings);
  for (const std::string& assignment : request.settings) {
    config = with_settings(config, std::vector{parse_assignment(assignment)});
  }
  return config;
}

}  // namespace stillpoint
