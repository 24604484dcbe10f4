// SPDX-License-Identifier: BSD-3-Clause
/// Files that appear together, whole, or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint {

struct OutputFile {
  std::string name;
  std::string text;
};

/// Proves that a file can be written in a folder, or in the nearest one above that exists: asked before hours
/// of work, not after. Leaves no trace.
/// @throws InputError if it cannot
void require_writable(const std::filesystem::path& folder);

/// A variant's name as the name of a folder.
[[nodiscard]] std::string folder_name(std::string variant);

/// Writes all files under temporary names and renames them when every one is complete.
/// @throws InputError if the folder cannot be written or the disk is full; nothing new is left then
void write_files(const std::filesystem::path& folder, const std::vector<OutputFile>& files);

}  // namespace stillpoint
