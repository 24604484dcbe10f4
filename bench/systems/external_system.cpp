// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/external_system.h"

#include <filesystem>

#include "bench/config/apply_settings.h"
#include "bench/config/toml_source.h"
#include "bench/model/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {

ExternalSystem load_external_system(const std::string& name) {
  const TomlSource source = find_toml(name, TomlKind::kSystem);
  ExternalSystem system = with_settings(ExternalSystem{}, parse_settings(source.text, source.path));
  if (system.name.empty()) throw InputError(source.path, "has no name; add name = \"...\"");
  if (system.command.empty())
    throw InputError(source.path, "has no command; add command = [\"program\", ...]");
  system.folder = std::filesystem::absolute(source.path).parent_path().string();
  system.hash = hash_text(content_hash(source.text));
  return system;
}

}  // namespace stillpoint::bench
