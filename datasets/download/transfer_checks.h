// SPDX-License-Identifier: BSD-3-Clause
/// What the operations of this folder have in common: how they report their progress and are stopped, and
/// the checks of disk space, kind and digests of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace stillpoint::datasets {

/// Progress and end of a long operation. Empty functions are not called.
struct TransferControl {
  /// Bytes that are complete, and their total; the total is 0 while it is not known.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  std::function<bool()> stop;  ///< true: end the operation, and keep what a later one can continue
  std::function<void(const std::string&)> report;  ///< one line about a retry or another mirror
};

[[nodiscard]] inline bool is_stopped(const TransferControl& control) {
  return control.stop && control.stop();
}
inline void report_progress(const TransferControl& control, std::uint64_t done, std::uint64_t total) {
  if (control.progress) control.progress(done, total);
}
inline void report_line(const TransferControl& control, const std::string& text) {
  if (control.report) control.report(text);
}

/// @param folder exists
/// @throws InputError if fewer than `bytes` and a reserve of 64 MB are free on its disk
void require_disk_space(const std::filesystem::path& folder, std::uint64_t bytes);

/// Whether the bytes begin like an HTML or XML page, as sent by servers instead of a missing file.
[[nodiscard]] bool is_html(std::string_view first_bytes);

/// Whether the name is that of an archive which `extract_archive` reads: .tar, .tgz, .tar.gz, .tar.bz2,
/// .tar.xz, .zip, .7z.
[[nodiscard]] bool has_archive_name(const std::filesystem::path& file);

/// What contradicts the extension of the name, e.g. "is not a gzip file"; empty if nothing does, or if the
/// extension is not known.
/// @throws InputError if the file cannot be read
[[nodiscard]] std::string content_problem(const std::filesystem::path& file, const std::string& name);

struct CryptographicDigests {
  std::uint64_t bytes = 0;
  std::string sha256;  ///< lower-case hexadecimal digits
  std::string md5;     ///< lower-case hexadecimal digits
};

/// Reads a file of any size in blocks.
/// @return empty if stopped
/// @throws InputError if it cannot be read
[[nodiscard]] std::optional<CryptographicDigests> digest_file(const std::filesystem::path& file,
                                                              const TransferControl& control);

}  // namespace stillpoint::datasets
