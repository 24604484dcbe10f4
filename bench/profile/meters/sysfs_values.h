// SPDX-License-Identifier: BSD-3-Clause
/// Values in files of /sys, /proc and /etc: one line per file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

/// First line without surrounding white space and zero bytes; nothing if it is empty or not readable.
[[nodiscard]] std::optional<std::string> line_in(const std::filesystem::path& file);

/// Nothing unless the whole text is one decimal integer that fits 64 bits.
[[nodiscard]] std::optional<std::int64_t> number_of(std::string_view text);

/// The number of a file that contains nothing else in its first line.
[[nodiscard]] std::optional<std::int64_t> number_in(const std::filesystem::path& file);

/// Entries whose names begin with `start`, sorted by name; empty if the folder does not exist.
[[nodiscard]] std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder,
                                                            std::string_view start);

}  // namespace stillpoint::bench
