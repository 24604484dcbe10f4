// SPDX-License-Identifier: BSD-3-Clause
/// Atomic output of a group of files: all of them complete, or none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint::bench {

struct OutputFile {
  std::string name;
  std::string text;
};

/// Checks, before a long computation, that a file can be written in a folder, or in its nearest existing
/// parent. Leaves no file behind.
/// @throws InputError if it cannot be written
void require_writable(const std::filesystem::path& folder);

/// Folder name of a variant.
[[nodiscard]] std::string folder_name(std::string variant);

/// Writes all files under temporary names and renames them when all are complete.
/// @throws InputError if the folder cannot be written or the disk is full; no new file remains
void write_files(const std::filesystem::path& folder, const std::vector<OutputFile>& files);

}  // namespace stillpoint::bench
