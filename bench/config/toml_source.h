// SPDX-License-Identifier: BSD-3-Clause
/// Finds configs, plans, systems, boards and published tables by name among the embedded files, or by path on
/// disk.
#pragma once

#include <string>
#include <vector>

namespace stillpoint {

/// A TOML text and where it came from.
struct TomlSource {
  std::string place;  ///< as messages name it; for embedded files their path in the sources
  std::string text;
  bool embedded = false;
};

/// The families of files, by the folder they live in.
enum class TomlFamily { kConfig, kPlan, kSystem, kPublished, kBoard };

/// A name that ends in ".toml" is a file on disk; any other is embedded, with or without its folder
/// ("wo_circular_mask" and "ablations/wo_circular_mask" are the same).
/// @throws InputError if there is no such file, with the nearest name
[[nodiscard]] TomlSource find_toml(const std::string& name, TomlFamily family);

/// The file that `heir` names as its parent: relative to itself when the name ends in ".toml".
/// @throws InputError if there is no such file
[[nodiscard]] TomlSource find_parent(const TomlSource& heir, const std::string& parent);

/// Names of all embedded files of a family, e.g. "ablations/wo_circular_mask", in alphabetical order.
[[nodiscard]] std::vector<std::string> embedded_names(TomlFamily family);

}  // namespace stillpoint
