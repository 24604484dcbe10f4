// SPDX-License-Identifier: BSD-3-Clause
/// A small sequence with IMU data, rendered once for the programs of a build, and modifiable copies of it.
#pragma once

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// Folder of a 3 s sequence of an empty office at 320x240 and 30 Hz in OpenLORIS layout. Read-only.
[[nodiscard]] const std::filesystem::path& rendered_sequence();

/// A copy for modification. Its images are hard links: replace them, do not write to them.
[[nodiscard]] std::filesystem::path copy_of_rendered_sequence(const TemporaryFolder& folder);

}  // namespace stillpoint
