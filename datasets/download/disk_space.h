// SPDX-License-Identifier: BSD-3-Clause
/// Checks disk space before it is needed.
#pragma once

#include <cstdint>
#include <filesystem>

namespace stillpoint::datasets {

/// @param folder exists
/// @throws InputError if fewer than `bytes` and a reserve of 64 MB are free on its disk
void require_disk_space(const std::filesystem::path& folder, std::uint64_t bytes);

}  // namespace stillpoint::datasets
