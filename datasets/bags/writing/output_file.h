// SPDX-License-Identifier: BSD-3-Clause
/// A binary file that gets its name when it is complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace stillpoint::datasets {

/// Writes to NAME.part, which is removed unless `finish` is called.
class OutputFile {
 public:
  /// @throws InputError if it cannot be created
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] std::uint64_t position() const { return position_; }
  void append(std::string_view bytes);

  /// Replaces bytes that were written before.
  void overwrite(std::uint64_t position, std::string_view bytes);

  /// Renames the file.
  /// @throws InputError if it could not be written completely
  void finish();

 private:
  [[nodiscard]] std::filesystem::path unfinished() const { return path_.string() + ".part"; }

  std::filesystem::path path_;
  std::ofstream out_;
  std::uint64_t position_ = 0;
  bool finished_ = false;
};

}  // namespace stillpoint::datasets
