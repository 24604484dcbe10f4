// SPDX-License-Identifier: BSD-3-Clause
/// Content-addressed files, compressed with zstd: the large data of a store.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

class BlobFiles {
 public:
  /// @param folder need not exist before the first `put`
  explicit BlobFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Stores a content unless it is stored already, and syncs it to disk; a damaged file is replaced. Safe for
  /// concurrent processes and threads.
  /// @return its name: 32 hexadecimal digits, two XXH64 of the content
  /// @throws InputError if it cannot be written; no partial file remains
  [[nodiscard]] std::string put(std::string_view content) const;

  /// @throws InputError if the file is missing, not zstd, or its content has another hash
  [[nodiscard]] std::string get(const std::string& name) const;

  /// Whether `get` has the content.
  [[nodiscard]] bool is_readable(const std::string& name) const;

  /// Names of all stored files, sorted.
  [[nodiscard]] std::vector<std::string> names() const;

  void remove(const std::string& name) const;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

/// Name under which a content is stored.
[[nodiscard]] std::string blob_name(std::string_view content);

}  // namespace stillpoint::bench
