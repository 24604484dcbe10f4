// SPDX-License-Identifier: BSD-3-Clause
/// Files named by a hash of their content, compressed with zstd: the bulky part of a store.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

class BlobFiles {
 public:
  /// @param folder need not exist before the first `put`
  explicit BlobFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Keeps a content, once; on return it is on the disk. Several processes may put the same at once.
  /// @return its name: 32 hexadecimal digits, two XXH64 of the content
  /// @throws InputError if it cannot be written; nothing is left behind then
  [[nodiscard]] std::string put(std::string_view content) const;

  /// @throws InputError if the file is missing, no zstd, or its content has another hash
  [[nodiscard]] std::string get(const std::string& name) const;

  /// Names of all files that are there, in alphabetical order.
  [[nodiscard]] std::vector<std::string> names() const;

  void remove(const std::string& name) const;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

/// The name that a content has.
[[nodiscard]] std::string blob_name(std::string_view content);

}  // namespace stillpoint
