// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/file_digests.h"

#include <chrono>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/io/file_bytes.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTitle = "# stillpoint digests 1: folder; digest size modified inode name";
constexpr std::int64_t kTimeResolution_ns = 100'000'000;  ///< ext4 and xfs: 4 to 10 ms
constexpr std::size_t kHashDigits = 16;

/// The lines of an index file; its last line is the checksum of the others. Empty if the file is damaged.
std::string checked_lines(const fs::path& index_file) {
  std::string text = file_bytes(index_file).value_or("");
  if (text.size() < kHashDigits || !text.starts_with(kTitle)) return {};
  const std::string checksum = text.substr(text.size() - kHashDigits);
  text.resize(text.size() - kHashDigits);
  return hash_text(content_hash(text)) == checksum ? text : std::string{};
}

std::int64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

void write_text(const fs::path& file, const std::string& text) {
  const fs::path partial = file.string() + "." + std::to_string(::getpid()) + kUnfinishedExtension;
  std::ofstream out(partial, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(partial, file, error);
  if (out && !error) return;
  fs::remove(partial, error);
  throw InputError(file.string(), "cannot be written; check free disk space and folder permissions");
}

}  // namespace

std::optional<FileDigest> digest_of_file(const fs::path& file) {
  const std::optional<FileState> before = file_state(file);
  if (!before) return FileDigest{};
  const std::optional<std::string> bytes = file_bytes(file);
  if (!bytes || file_state(file) != before) return std::nullopt;
  return FileDigest{.state = *before, .digest = content_hash(*bytes)};
}

FileDigests::FileDigests(const fs::path& folder, fs::path index_file)
    : folder_(folder), index_file_(std::move(index_file)) {
  std::istringstream lines(checked_lines(index_file_));
  std::string line;
  std::getline(lines, line);  // title
  std::getline(lines, line);
  if (line != fs::canonical(folder_).string()) return;  // two folders with the same hash
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    FileDigest entry;
    std::string name;
    row >> std::hex >> entry.digest >> std::dec >> entry.state.size >> entry.state.modified_ns >>
        entry.state.inode;
    if (row && row.get() == ' ' && std::getline(row, name)) digests_[name] = entry;
  }
}

std::string FileDigests::name_of(const fs::path& file) const {
  return file.lexically_relative(folder_).string();
}

std::optional<std::uint64_t> FileDigests::find(const fs::path& file) const {
  const std::optional<FileState> state = file_state(file);
  if (!state) return kNoFileDigest;
  const auto found = digests_.find(name_of(file));
  if (found == digests_.end() || found->second.state != *state) return std::nullopt;
  return found->second.digest;
}

void FileDigests::add(const fs::path& file, const FileDigest& digest) { digests_[name_of(file)] = digest; }

void FileDigests::save() const {
  const std::int64_t newest = now_ns() - kTimeResolution_ns;
  std::ostringstream text;
  text << kTitle << '\n' << fs::canonical(folder_).string() << '\n';
  for (const auto& [name, entry] : digests_) {
    if (entry.digest == kNoFileDigest || entry.state.modified_ns > newest) continue;
    text << std::hex << entry.digest << std::dec << ' ' << entry.state.size << ' ' << entry.state.modified_ns
         << ' ' << entry.state.inode << ' ' << name << '\n';
  }
  write_text(index_file_, text.str() + hash_text(content_hash(text.str())));
}

std::optional<fs::path> folder_of_digests(const fs::path& index_file) {
  std::istringstream lines(checked_lines(index_file));
  std::string folder;
  std::getline(lines, folder);
  if (!std::getline(lines, folder)) return std::nullopt;
  return folder;
}

fs::path digests_file(const fs::path& cache, const fs::path& sequence) {
  return cache / (hash_text(content_hash(fs::canonical(sequence).string())) + kDigestsExtension);
}

}  // namespace stillpoint::datasets
