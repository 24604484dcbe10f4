// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/archive_extraction.h"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <isa-l/igzip_lib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

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

enum class EntryKind { kFile, kFolder };

struct ArchiveEntry {
  fs::path path;  ///< relative, normal, without ".."
  EntryKind kind = EntryKind::kFile;
};

/// Sequential reader of the entries of an archive.
class ArchiveReader {
 public:
  /// @throws InputError if the file cannot be opened, or is not a tar, zip or 7z archive
  explicit ArchiveReader(const fs::path& file);

  /// The next entry; empty at the end. Entries that are the folder itself are skipped.
  /// @throws InputError if the archive is damaged, or the entry is encrypted, a link or a device, or has a
  /// path outside of the archive
  [[nodiscard]] std::optional<ArchiveEntry> next();

  /// Reads the next bytes of the current entry. @return number of bytes; 0 at the end
  /// @throws InputError if the archive is damaged
  [[nodiscard]] std::size_t read(std::span<char> bytes);

  /// Number of bytes of the archive that were read.
  [[nodiscard]] std::uint64_t position() const;

 private:
  [[noreturn]] void fail(const std::string& problem) const;

  fs::path file_;
  std::unique_ptr<archive, int (*)(archive*)> archive_;
};

ArchiveReader::ArchiveReader(const fs::path& file) : file_(file), archive_(new_reader(), archive_read_free) {
  if (archive_read_open_filename(archive_.get(), file.c_str(), kReadBytes) != ARCHIVE_OK)
    fail("is not a readable archive: " + error_of(archive_.get()));
}

void ArchiveReader::fail(const std::string& problem) const {
  throw InputError(file_.string(), problem + "; remove it, and download it again");
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

constexpr std::size_t kBlockBytes = 1U << 20U;
constexpr double kUnratedBytes = 100e6;                // small archives may be compressed to any extent
constexpr std::uint64_t kSpaceCheckBytes = 1U << 28U;  // interval of checks of the disk
constexpr mode_t kExtractedMode = 0666;

/// A new file; existing ones are replaced, links are not followed.
class OutputFileDescriptor {
 public:
  explicit OutputFileDescriptor(const fs::path& file)
      : file_(file),
        descriptor_(
            open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, kExtractedMode)) {
    if (descriptor_ < 0) fail();
  }
  ~OutputFileDescriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  OutputFileDescriptor(const OutputFileDescriptor&) = delete;
  OutputFileDescriptor& operator=(const OutputFileDescriptor&) = delete;

  void append(std::span<const char> bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail();
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
  }

 private:
  [[noreturn]] void fail() const {
    throw InputError(file_.string(), std::string("cannot be written: ") + std::strerror(errno) +
                                         "; free disk space, then run the command again");
  }

  fs::path file_;
  int descriptor_;
};

/// "a/seq-01.tar.gz" -> "a/seq-01".
fs::path without_archive_extension(fs::path file) {
  file.replace_extension();
  return file.extension() == ".tar" ? file.replace_extension() : file;
}

/// Extraction of one archive file, without the archives in it.
class Extraction {
 public:
  Extraction(const fs::path& archive, const ExtractionLimits& limits, const TransferControl& control)
      : archive_(archive),
        limits_(limits),
        control_(control),
        totals_(limits.before),
        before_(limits.before.bytes),
        archive_bytes_(fs::file_size(archive)),
        reader_(archive),
        block_(kBlockBytes) {}

  /// @param top folder of entries that is left out of their paths; may be empty
  void extract_to(const fs::path& folder, const fs::path& top) {
    fs::create_directories(folder);
    while (const std::optional<ArchiveEntry> entry = reader_.next()) {
      if (++totals_.entries > limits_.max_entries)
        fail(fmt::format("has more than {} entries", limits_.max_entries));
      const fs::path relative = without_top(entry->path, top);
      if (relative.empty()) continue;
      const fs::path target = folder / relative;
      if (entry->kind == EntryKind::kFolder) {
        create_folder(target);
      } else {
        create_folder(target.parent_path());
        extract_file(target);
        if (has_archive_name(target)) nested_.push_back(target);
      }
      if (totals_.stopped) return;
    }
  }

  [[nodiscard]] const ExtractionTotals& totals() const { return totals_; }
  [[nodiscard]] const std::vector<fs::path>& nested() const { return nested_; }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(archive_.string(),
                     problem + "; an archive of a dataset would not: do not use this file");
  }

  static fs::path without_top(const fs::path& path, const fs::path& top) {
    if (top.empty() || *path.begin() != top) return path;
    fs::path rest;
    for (auto part = std::next(path.begin()); part != path.end(); ++part) rest /= *part;
    return rest;
  }

  void create_folder(const fs::path& folder) const {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw InputError(folder.string(), "cannot be created: " + error.message());
  }

  void extract_file(const fs::path& target) {
    const OutputFileDescriptor output(target);
    while (const std::size_t count = reader_.read(block_)) {
      totals_.bytes += count;
      require_within_limits();
      output.append(std::span(block_).first(count));
      report_progress(control_, std::min(reader_.position(), archive_bytes_), archive_bytes_);
      if (!is_stopped(control_)) continue;
      totals_.stopped = true;
      return;
    }
  }

  void require_within_limits() {
    if (totals_.bytes > limits_.max_bytes)
      fail(fmt::format("contains more than {} bytes", limits_.max_bytes));
    const double ratio_limit = kUnratedBytes + limits_.max_ratio * static_cast<double>(archive_bytes_);
    if (static_cast<double>(totals_.bytes - before_) > ratio_limit)
      fail(fmt::format("contains more than {:.0f} times its size", limits_.max_ratio));
    if (totals_.bytes < next_space_check_) return;
    require_disk_space(archive_.parent_path(), 0);
    next_space_check_ = totals_.bytes + kSpaceCheckBytes;
  }

  fs::path archive_;
  const ExtractionLimits& limits_;
  const TransferControl& control_;
  ExtractionTotals totals_;
  std::uint64_t before_;  ///< extracted bytes of earlier archives
  std::uint64_t archive_bytes_;
  std::uint64_t next_space_check_ = 0;
  ArchiveReader reader_;
  std::vector<char> block_;
  std::vector<fs::path> nested_;
};

/// Inflates a gzip file, of one or several members, to its end: libarchive does not verify their checksums.
/// @return false if it is damaged
bool is_intact_gzip(std::istream& input, const TransferControl& control) {
  constexpr std::uint8_t kMagic = 0x1f;
  std::vector<std::uint8_t> compressed(kReadBytes);
  std::vector<std::uint8_t> content(kBlockBytes);
  inflate_state state;
  isal_inflate_init(&state);
  state.crc_flag = ISAL_GZIP;
  const auto read_more = [&] {
    input.read(reinterpret_cast<char*>(compressed.data()), static_cast<std::streamsize>(compressed.size()));
    state.next_in = compressed.data();
    state.avail_in = static_cast<std::uint32_t>(input.gcount());
    return state.avail_in > 0;
  };
  read_more();
  while (!is_stopped(control)) {
    state.next_out = content.data();
    state.avail_out = static_cast<std::uint32_t>(content.size());
    if (isal_inflate(&state) != ISAL_DECOMP_OK) return false;
    if (state.block_state == ISAL_BLOCK_FINISH) {
      const bool has_more = state.avail_in > 0 || read_more();
      if (!has_more || *state.next_in != kMagic) return true;  // gzip ignores other bytes, too
      isal_inflate_reset(&state);
      state.crc_flag = ISAL_GZIP;
    } else if (state.avail_in == 0 && state.avail_out > 0 && !read_more()) {
      return false;
    }
  }
  return true;
}

/// @throws InputError if the file is a damaged gzip file
void require_intact_gzip(const fs::path& file, const TransferControl& control) {
  std::ifstream input(file, std::ios::binary);
  const bool is_gzip = input.get() == 0x1f && input.get() == 0x8b;
  input.seekg(0);
  if (is_gzip && !is_intact_gzip(input, control))
    throw InputError(file.string(),
                     "is damaged: the checksum of its content is wrong; remove it, and "
                     "download it again");
}

/// An archive, and the folder for its content.
struct ArchiveToExtract {
  fs::path archive;
  fs::path folder;
  int depth = 0;  ///< number of archives around this one
};

ExtractionTotals extract(const ArchiveToExtract& source, ExtractionLimits limits,
                         const TransferControl& control) {
  std::vector<fs::path> nested;
  {
    Extraction extraction(source.archive, limits, control);
    extraction.extract_to(source.folder, source.depth == 0 ? fs::path() : source.folder.filename());
    limits.before = extraction.totals();
    nested = extraction.nested();
  }
  // After the extraction, which the limits apply to.
  if (!limits.before.stopped) require_intact_gzip(source.archive, control);
  for (const fs::path& file : nested) {
    if (limits.before.stopped) break;
    if (source.depth >= limits.max_depth)
      throw InputError(
          file.string(),
          fmt::format("is an archive in more than {} archives; extract it by hand", limits.max_depth));
    limits.before = extract({file, without_archive_extension(file), source.depth + 1}, limits, control);
    if (!limits.before.stopped) fs::remove(file);
  }
  return limits.before;
}

}  // namespace

ExtractionTotals extract_archive(const fs::path& archive, const fs::path& folder,
                                 const ExtractionLimits& limits, const TransferControl& control) {
  return extract({archive, folder}, limits, control);
}

}  // namespace stillpoint::datasets
