// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/cache_key.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/cache/frame_file.h"
#include "datasets/io/image_io.h"

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

namespace {

/// The bits of all numbers in the order in which they were added.
class Bits {
 public:
  void add(std::uint64_t value) { words_.push_back(value); }
  void add(double value) { words_.push_back(std::bit_cast<std::uint64_t>(value)); }

  void add(const Camera& camera) {
    add(static_cast<std::uint64_t>(camera.width));
    add(static_cast<std::uint64_t>(camera.height));
    for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) add(value);
    add(static_cast<std::uint64_t>(camera.model));
    for (const double value : camera.coefficients()) add(value);
  }

  void add(const Pose& pose) {
    for (int i = 0; i < 3; ++i) add(pose.p[i]);
    for (int i = 0; i < 4; ++i) add(pose.q.coeffs()[i]);
  }

  [[nodiscard]] std::uint64_t hash(std::uint64_t seed) const {
    return content_hash({reinterpret_cast<const char*>(words_.data()), words_.size() * sizeof(std::uint64_t)},
                        seed);
  }

 private:
  std::vector<std::uint64_t> words_;
};

bool is_png(const fs::path& file) {
  return file.empty() || file.extension() == ".png" || file.extension() == ".PNG";
}

/// Versions of the libraries that decode lossy formats. All decoders give the same pixels of a PNG, and
/// loading OpenImageIO to ask for its version takes longer than opening the cache.
std::string decoder_of(const SequenceContent& content) {
  const bool lossless = std::ranges::all_of(content.frame_files, [](const FrameFiles& files) {
    return is_png(files.color) && is_png(files.depth);
  });
  return lossless ? "PNG" : image_decoder_version();
}

}  // namespace

std::uint64_t cache_key(const SequenceContent& content, std::span<const FrameDigest> frames) {
  Bits bits;
  bits.add(std::uint64_t{kFrameFileVersion});
  bits.add(kDecodingVersion);
  bits.add(content.info.rig.camera);
  bits.add(content.info.rig.depth_units_per_m);
  if (content.info.rig.depth_offset != 0.0) bits.add(content.info.rig.depth_offset);
  bits.add(std::uint64_t{content.no_depth_value});
  bits.add(std::uint64_t{content.info.depth_camera.has_value()});
  if (content.info.depth_camera) {
    bits.add(content.info.depth_camera->camera);
    bits.add(content.info.depth_camera->T_c_d);
  }
  bits.add(std::uint64_t{frames.size()});
  for (const FrameDigest& frame : frames) {
    bits.add(frame.color);
    bits.add(frame.depth);
  }
  return bits.hash(content_hash(decoder_of(content)));
}

fs::path frame_file(const fs::path& cache, std::uint64_t key) {
  return cache / (hash_text(key) + kFrameFileExtension);
}

}  // namespace stillpoint::datasets
