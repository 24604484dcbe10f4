// SPDX-License-Identifier: BSD-3-Clause
/// Output of files that is safe: a group of files is complete or absent, and inputs and files that this
/// program did not write are not overwritten.
#pragma once

#include <filesystem>
#include <optional>
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

/// What a single output file may replace.
struct OutputRules {
  std::vector<std::filesystem::path> inputs;  ///< files and folders that the command reads; empty: ignored
  std::optional<bool> force{};  ///< --force, if there is one: replace an existing file of the kind
  std::string beginning;        ///< of each file of this kind, e.g. "<svg"
};

/// Checks an output file before the work begins. A file that does not exist or is empty passes; an existing
/// one requires `force` and the beginning of its kind. Links are followed.
/// @throws InputError if the file is one of the inputs, a folder, pipe or device, or must not be replaced
void require_safe_output(const std::filesystem::path& file, const OutputRules& rules);

/// Checks as `require_safe_output` and writes the file atomically.
/// @throws InputError in addition if it cannot be written; an existing file is then unchanged
void write_output(const std::filesystem::path& file, const std::string& text, const OutputRules& rules);

/// What a command writes into an output folder.
struct OutputLayout {
  std::vector<std::string> names;  ///< files and subfolders
  std::vector<std::vector<std::string>>
      marks;  ///< sets of names; an earlier output contains one complete set
};

/// Whether a folder contains an earlier output of this kind.
[[nodiscard]] bool has_earlier_output(const std::filesystem::path& folder, const OutputLayout& layout);

/// Checks an output folder before the work begins. The files of an earlier output are replaced; a folder that
/// contains one of the names but no set of marks was not written by this program.
/// @param inputs as in OutputRules
/// @throws InputError if the folder is an input folder, one of its files is an input, or it contains files of
/// another origin
void require_safe_folder(const std::filesystem::path& folder, const OutputLayout& layout,
                         const std::vector<std::filesystem::path>& inputs);

}  // namespace stillpoint::bench
