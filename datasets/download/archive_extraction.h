// SPDX-License-Identifier: BSD-3-Clause
/// Extracts archives of unknown origin: tar (none, gzip, bzip2, xz, zstd), zip and 7z.
#pragma once

#include <cstdint>
#include <filesystem>

#include "datasets/download/transfer_checks.h"

namespace stillpoint::datasets {

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
