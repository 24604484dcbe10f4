// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/archive_reader.h"

#include <algorithm>

#include <archive.h>
#include <archive_entry.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBytes = 1U << 18U;
constexpr std::size_t kMaxPathBytes = 1000;

/// Only formats that read nothing but the archive, and run no other program.
archive* new_reader() {
  archive* reader = archive_read_new();
  STILLPOINT_CHECK(reader != nullptr);
  archive_read_support_filter_gzip(reader);
  archive_read_support_filter_bzip2(reader);
  archive_read_support_filter_xz(reader);
  archive_read_support_filter_zstd(reader);
  archive_read_support_format_tar(reader);
  archive_read_support_format_zip(reader);
  archive_read_support_format_7zip(reader);
  return reader;
}

std::string error_of(archive* reader) {
  const char* text = archive_error_string(reader);
  return text == nullptr ? "damaged" : escaped_utf8(text);
}

}  // namespace

ArchiveReader::ArchiveReader(const fs::path& file) : file_(file), archive_(new_reader(), archive_read_free) {
  if (archive_read_open_filename(archive_.get(), file.c_str(), kReadBytes) != ARCHIVE_OK)
    fail("is not a readable archive: " + error_of(archive_.get()));
}

void ArchiveReader::fail(const std::string& problem) const {
  throw InputError(file_.string(), problem + "; download it again");
}

std::optional<ArchiveEntry> ArchiveReader::next() {
  for (;;) {
    archive_entry* entry = nullptr;
    const int result = archive_read_next_header(archive_.get(), &entry);
    if (result == ARCHIVE_EOF) return std::nullopt;
    if (result != ARCHIVE_OK && result != ARCHIVE_WARN)
      fail("is not a complete archive: " + error_of(archive_.get()));
    const char* name = archive_entry_pathname(entry);
    const std::string text = name == nullptr ? "" : name;
    const fs::path path = fs::path(text).lexically_normal();
    const std::string place = "has the entry \"" + escaped_utf8(text) + "\", which ";
    if (text.empty() || text.size() > kMaxPathBytes) fail(place + "has no usable name");
    if (path.is_absolute() || std::ranges::any_of(path, [](const auto& part) { return part == ".."; }))
      fail(place + "is outside of the archive");
    if (archive_entry_hardlink(entry) != nullptr || archive_entry_symlink(entry) != nullptr)
      fail(place + "is a link");
    if (archive_entry_is_encrypted(entry) != 0) fail(place + "is encrypted");
    const auto type = archive_entry_filetype(entry);
    if (type != AE_IFREG && type != AE_IFDIR) fail(place + "is neither a file nor a folder");
    if (path == "." || path == "./") continue;
    return ArchiveEntry{path.has_filename() ? path : path.parent_path(),
                        type == AE_IFDIR ? EntryKind::kFolder : EntryKind::kFile};
  }
}

std::size_t ArchiveReader::read(std::span<char> bytes) {
  const la_ssize_t count = archive_read_data(archive_.get(), bytes.data(), bytes.size());
  if (count < 0) fail("is damaged: " + error_of(archive_.get()));
  return static_cast<std::size_t>(count);
}

std::uint64_t ArchiveReader::position() const {
  return static_cast<std::uint64_t>(std::max<la_int64_t>(0, archive_filter_bytes(archive_.get(), -1)));
}

}  // namespace stillpoint::datasets
