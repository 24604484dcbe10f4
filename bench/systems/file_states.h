// SPDX-License-Identifier: BSD-3-Clause
/// Changes of files in folders in which a program must not write, e.g. of the sequence that it reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint::bench {

/// Size and time of a file.
using FileState = std::pair<std::uintmax_t, std::filesystem::file_time_type>;
using FileStates = std::map<std::filesystem::path, FileState>;

/// Adds the files of a folder.
/// @param states   receives the files by their paths
/// @param folder   may be a file, or missing
/// @param depth    of subfolders; those that are symbolic links are not followed
/// @param excluded folder whose files are not added; those of `__pycache__` never are
void add_files(FileStates& states, const std::filesystem::path& folder, int depth,
               const std::filesystem::path& excluded);

/// New and changed files.
[[nodiscard]] std::vector<std::filesystem::path> written_files(const FileStates& before,
                                                               const FileStates& after);

/// New, changed and removed files.
[[nodiscard]] std::vector<std::filesystem::path> changed_files(const FileStates& before,
                                                               const FileStates& after);

/// Finds changes of sequences by the sizes and times of their files. Hidden files, as those of file managers,
/// editors and NFS, do not count: no reader reads them.
class SequenceWatch {
 public:
  /// The files of a sequence that changed since the first call for it, e.g. "seq/imu.txt removed, seq/a.txt
  /// new and 3 more"; empty if there are none.
  /// @param sequence folder or file
  [[nodiscard]] std::string changes_of(const std::filesystem::path& sequence);

 private:
  std::map<std::filesystem::path, FileStates> first_;
};

}  // namespace stillpoint::bench
