// SPDX-License-Identifier: BSD-3-Clause
/// Exported sequences in the cache, which several runs read. A program that writes into one would change the
/// data of all later runs.
#pragma once

#include <filesystem>
#include <functional>

namespace stillpoint::bench {

/// An export is intact if its files have the sizes and times with which they were written; further files do
/// not count.
enum class ExportState { kNone, kIntact, kChanged };

/// @param path folder or file; the list of its files is beside it
[[nodiscard]] ExportState export_state(const std::filesystem::path& path);

/// Writes an export unless it is intact; beside it are the list of its files and a lock.
/// @param path  folder or file
/// @param write creates `path`
void require_export(const std::filesystem::path& path, const std::function<void()>& write);

}  // namespace stillpoint::bench
