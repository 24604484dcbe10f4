// SPDX-License-Identifier: BSD-3-Clause
/// Writes archives of every supported kind.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint {

struct TestEntry {
  std::string path;
  std::string content;
  std::string link_target = {};  ///< not empty: a symbolic link
};

/// @param file its extension selects the kind: .tgz, .tar, .tar.xz, .tar.bz2, .zip or .7z
void write_archive(const std::filesystem::path& file, const std::vector<TestEntry>& entries);

/// All files below a folder as entries, sorted; paths begin with `prefix`.
[[nodiscard]] std::vector<TestEntry> folder_entries(const std::filesystem::path& folder,
                                                    const std::string& prefix);

}  // namespace stillpoint
