// SPDX-License-Identifier: BSD-3-Clause
/// Finds configs, plans, systems, devices, published tables and catalogues of datasets among the embedded
/// files or on disk.
///
/// Source files embedded in the executable, so that it does not depend on installed data files.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

struct EmbeddedFile {
  std::string_view path;  ///< relative to the source root, e.g. "bench/configs/vo.toml"
  std::string_view text;
};

/// The TOML files of configs, plans, systems, devices, published tables and catalogues, sorted by path.
[[nodiscard]] std::span<const EmbeddedFile> embedded_files();

/// The files of reports/web; defined in the reports library.
[[nodiscard]] std::span<const EmbeddedFile> web_files();

/// A TOML text and its origin.
struct TomlSource {
  std::string path;  ///< as shown in messages; for embedded files relative to the source root
  std::string text;
  bool embedded = false;
};

/// Kinds of files; each kind has its own folder.
enum class TomlKind { kConfig, kPlan, kSystem, kPublished, kDevice, kCatalogue };

/// A name that ends in ".toml" is a file on disk; any other is an embedded file, with or without its folder
/// ("wo_circular_mask" and "ablations/wo_circular_mask" are equivalent).
/// @throws InputError if there is no such file; the message suggests the nearest name
[[nodiscard]] TomlSource find_toml(const std::string& name, TomlKind kind);

/// The config that `child` inherits; a name that ends in ".toml" is relative to the folder of `child`.
/// @throws InputError if there is no such file
[[nodiscard]] TomlSource find_parent(const TomlSource& child, const std::string& parent);

/// Names of all embedded files of a kind, e.g. "ablations/wo_circular_mask", in alphabetical order.
[[nodiscard]] std::vector<std::string> embedded_names(TomlKind kind);

}  // namespace stillpoint::bench
