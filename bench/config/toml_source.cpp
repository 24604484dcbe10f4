// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/toml_source.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "bench/config/embedded_files.h"
#include "bench/config/spelling.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Where the files of a family lie, and what one is called.
struct FamilyPlace {
  std::string root;
  std::string kind;
};

FamilyPlace place_of(TomlFamily family) {
  switch (family) {
    case TomlFamily::kConfig:
      return {"bench/configs/", "config"};
    case TomlFamily::kPlan:
      return {"bench/plans/", "plan"};
    case TomlFamily::kSystem:
      return {"bench/systems/", "system"};
    case TomlFamily::kPublished:
      return {"reports/published/", "published table"};
    case TomlFamily::kBoard:
      return {"bench/boards/", "board"};
  }
  return {};
}

TomlSource read_file(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!fs::is_regular_file(path) || !file) {
    throw InputError(path.string(), "cannot be read; give the path of an existing TOML file");
  }
  return {path.string(), text.str(), false};
}

std::optional<TomlSource> embedded_at(const std::string& path) {
  for (const EmbeddedFile& file : embedded_files()) {
    if (file.path == path) return TomlSource{path, std::string(file.text), true};
  }
  return std::nullopt;
}

/// True when `name` is the whole embedded name or its last part.
bool names(const std::string& name, const std::string& embedded) {
  return embedded == name || embedded.ends_with("/" + name);
}

}  // namespace

std::vector<std::string> embedded_names(TomlFamily family) {
  const std::string root = place_of(family).root;
  std::vector<std::string> result;
  for (const EmbeddedFile& file : embedded_files()) {
    if (!file.path.starts_with(root)) continue;
    result.push_back(fs::path(file.path.substr(root.size())).replace_extension().string());
  }
  return result;
}

TomlSource find_toml(const std::string& name, TomlFamily family) {
  if (name.ends_with(".toml")) return read_file(name);
  const std::vector<std::string> known = embedded_names(family);
  for (const std::string& candidate : known) {
    if (names(name, candidate)) return *embedded_at(place_of(family).root + candidate + ".toml");
  }
  throw InputError(place_of(family).kind + " \"" + name + "\"",
                   "there is none of this name" + suggestion(name, known));
}

TomlSource find_parent(const TomlSource& heir, const std::string& parent) {
  if (!parent.ends_with(".toml")) return find_toml(parent, TomlFamily::kConfig);
  const fs::path path = (fs::path(heir.place).parent_path() / parent).lexically_normal();
  if (!heir.embedded) return read_file(path);
  if (const std::optional<TomlSource> found = embedded_at(path.string())) return *found;
  throw InputError(heir.place, "inherits \"" + parent + "\", which is not embedded; correct the name");
}

}  // namespace stillpoint
