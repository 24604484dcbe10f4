// SPDX-License-Identifier: BSD-3-Clause
/// Sequential reader of the entries of an archive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

struct archive;

namespace stillpoint::datasets {

enum class EntryKind { kFile, kFolder };

struct ArchiveEntry {
  std::filesystem::path path;  ///< relative, normal, without ".."
  EntryKind kind = EntryKind::kFile;
};

class ArchiveReader {
 public:
  /// @throws InputError if the file cannot be opened, or is not a tar, zip or 7z archive
  explicit ArchiveReader(const std::filesystem::path& file);

  /// The next entry; empty at the end. Entries that are the folder itself are skipped.
  /// @throws InputError if the archive is damaged, or the entry is encrypted, a link or a device, or has a
  /// path outside of the archive
  [[nodiscard]] std::optional<ArchiveEntry> next();

  /// Reads the next bytes of the current entry. @return number of bytes; 0 at the end
  /// @throws InputError if the archive is damaged
  [[nodiscard]] std::size_t read(std::span<char> bytes);

  /// Number of bytes of the archive that were read.
  [[nodiscard]] std::uint64_t position() const;

 private:
  [[noreturn]] void fail(const std::string& problem) const;

  std::filesystem::path file_;
  std::unique_ptr<archive, int (*)(archive*)> archive_;
};

}  // namespace stillpoint::datasets
