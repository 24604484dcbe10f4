// SPDX-License-Identifier: BSD-3-Clause
/// The files of a folder, to compare folders.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace stillpoint {

/// Content of each file below a folder by its relative path.
[[nodiscard]] inline std::map<std::string, std::string> folder_contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    files[std::filesystem::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(in),
                                                                       {}};
  }
  return files;
}

}  // namespace stillpoint
