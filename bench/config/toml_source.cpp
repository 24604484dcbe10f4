// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/toml_source.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "bench/config/spelling.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxBytes = 16U << 20U;
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";  // some editors write it at the start of a file

/// Folder of a kind of files, and its name in messages.
struct KindInfo {
  std::string folder;
  std::string name;
};

KindInfo info_of(TomlKind kind) {
  switch (kind) {
    case TomlKind::kConfig:
      return {"bench/configs/", "config"};
    case TomlKind::kPlan:
      return {"bench/plans/", "plan"};
    case TomlKind::kSystem:
      return {"bench/systems/", "system"};
    case TomlKind::kPublished:
      return {"reports/published/", "published table"};
    case TomlKind::kDevice:
      return {"bench/devices/", "device"};
    case TomlKind::kCatalogue:
      return {"datasets/catalogue/", "catalogue"};
  }
  return {};
}

TomlSource read_file(const fs::path& path) {
  require_regular_file(path);
  std::error_code error;
  if (fs::file_size(path, error) > kMaxBytes && !error) {
    throw InputError(path.string(), "is larger than 16 MB; specify the path of a TOML file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), "cannot be read; specify the path of an existing TOML file");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw InputError(path.string(),
                     "is UTF-16 text; convert it to UTF-8, e.g. with `iconv -f UTF-16 -t UTF-8`");
  // toml++ 3.3 violates an assertion of its own for "[" and a NUL byte.
  if (text.find('\0') != std::string::npos)
    throw InputError(path.string(), "contains a NUL byte; it is not a text file");
  const bool has_mark = text.starts_with(kUtf8Mark);
  return {path.string(), has_mark ? text.substr(kUtf8Mark.size()) : text, false};
}

std::optional<TomlSource> embedded_at(const std::string& path) {
  for (const EmbeddedFile& file : embedded_files()) {
    if (file.path == path) return TomlSource{path, std::string(file.text), true};
  }
  return std::nullopt;
}

/// Whether `name` is the full embedded name or its last components.
bool name_matches(const std::string& name, const std::string& embedded) {
  return embedded == name || embedded.ends_with("/" + name);
}

}  // namespace

std::vector<std::string> embedded_names(TomlKind kind) {
  const std::string folder = info_of(kind).folder;
  std::vector<std::string> result;
  for (const EmbeddedFile& file : embedded_files()) {
    if (!file.path.starts_with(folder)) continue;
    result.push_back(fs::path(file.path.substr(folder.size())).replace_extension().string());
  }
  return result;
}

TomlSource find_toml(const std::string& name, TomlKind kind) {
  if (name.ends_with(".toml")) return read_file(name);
  const std::vector<std::string> known = embedded_names(kind);
  for (const std::string& candidate : known) {
    if (name_matches(name, candidate)) return *embedded_at(info_of(kind).folder + candidate + ".toml");
  }
  std::error_code ignored;
  const bool is_file = fs::exists(name, ignored);
  throw InputError("unknown " + info_of(kind).name + " \"" + name + "\"" +
                   (is_file ? "; the name of a file must end in .toml" : suggestion(name, known)));
}

TomlSource find_parent(const TomlSource& child, const std::string& parent) {
  if (!parent.ends_with(".toml")) return find_toml(parent, TomlKind::kConfig);
  const fs::path path = (fs::path(child.path).parent_path() / parent).lexically_normal();
  if (!child.embedded) return read_file(path);
  if (const std::optional<TomlSource> found = embedded_at(path.string())) return *found;
  throw InputError(child.path, "inherits \"" + parent + "\", which is not embedded; correct the name");
}

}  // namespace stillpoint::bench
