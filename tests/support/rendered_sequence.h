// SPDX-License-Identifier: BSD-3-Clause
/// A small sequence with an IMU, rendered once for a test program, and copies of it that may be spoiled.
#pragma once

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// Folder of 3 s of an empty office at 320x240 and 30 Hz in OpenLORIS layout. Read only.
[[nodiscard]] const std::filesystem::path& rendered_sequence();

/// A copy whose text files may be changed; its pictures are hard links: replace, never rewrite them.
[[nodiscard]] std::filesystem::path copy_of_rendered_sequence(const TemporaryFolder& folder);

}  // namespace stillpoint
