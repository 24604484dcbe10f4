// SPDX-License-Identifier: BSD-3-Clause
/// Extracts archives of unknown origin: tar (none, gzip, bzip2, xz, zstd), zip and 7z.
///
/// Sequential reader of the entries of an archive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "datasets/download/transfer_checks.h"

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

/// What has been extracted so far.
struct ExtractionTotals {
  std::uint64_t bytes = 0;
  std::uint64_t entries = 0;
  bool stopped = false;
};

/// Limits of all archives that are extracted together, nested ones included.
struct ExtractionLimits {
  std::uint64_t max_bytes = 2'000'000'000'000;
  std::uint64_t max_entries = 20'000'000;
  double max_ratio = 200.0;   ///< extracted bytes per byte of the archive, beyond 100 MB
  int max_depth = 2;          ///< of archives in archives
  ExtractionTotals before{};  ///< of archives that were extracted before under the same limits
};

/// Extracts files and folders into `folder`, which is created. Archives inside
/// are extracted into a folder with their name without extension, and removed; a top folder of the same name
/// inside a nested archive is left out. Modes and times of the archive are not used.
/// @return `limits.before` and this archive; `stopped` if it is incomplete because `control.stop` returned
/// true
/// @throws InputError if the file is not such an archive, is damaged or encrypted, exceeds a limit or the
/// disk, or has an entry that would be outside of the folder, a link or a device
[[nodiscard]] ExtractionTotals extract_archive(const std::filesystem::path& archive,
                                               const std::filesystem::path& folder,
                                               const ExtractionLimits& limits,
                                               const TransferControl& control);

}  // namespace stillpoint::datasets
