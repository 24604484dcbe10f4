// SPDX-License-Identifier: BSD-3-Clause
/// Rejects input paths that are not files, before they are opened.
#pragma once

#include <filesystem>

namespace stillpoint {

/// Opening a named pipe blocks until another process writes to it, and devices may never end.
/// @throws InputError if `file` is a folder, pipe, socket or device; a missing file is accepted, as the
/// caller reports it when it opens the file
void require_regular_file(const std::filesystem::path& file);

}  // namespace stillpoint
