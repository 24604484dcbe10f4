// SPDX-License-Identifier: BSD-3-Clause
/// Recognizes the kind of a file by its first bytes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace stillpoint::datasets {

/// Whether the bytes begin like an HTML or XML page, as sent by servers instead of a missing file.
[[nodiscard]] bool is_html(std::string_view first_bytes);

/// Whether the name is that of an archive which `extract_archive` reads: .tar, .tgz, .tar.gz, .tar.bz2,
/// .tar.xz, .zip, .7z.
[[nodiscard]] bool has_archive_name(const std::filesystem::path& file);

/// What contradicts the extension of the name, e.g. "is not a gzip file"; empty if nothing does, or if the
/// extension is not known.
/// @throws InputError if the file cannot be read
[[nodiscard]] std::string content_problem(const std::filesystem::path& file, const std::string& name);

}  // namespace stillpoint::datasets
