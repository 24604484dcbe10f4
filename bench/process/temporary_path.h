// SPDX-License-Identifier: BSD-3-Clause
/// A file or folder for temporary data, removed with its owner.
#pragma once

#include <filesystem>
#include <string>

namespace stillpoint::bench {

class TemporaryPath {
 public:
  enum class Kind { kFile, kFolder };

  /// Creates an empty file or folder with a unique name in the folder for temporary files (TMPDIR).
  /// @param purpose part of its name, e.g. "output"
  /// @throws InputError if it cannot be created
  TemporaryPath(Kind kind, const std::string& purpose);
  ~TemporaryPath();  ///< removes the folder with its content
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace stillpoint::bench
