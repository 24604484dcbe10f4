// SPDX-License-Identifier: BSD-3-Clause
/// Key of a frame cache file: everything that determines the decoded images. The digests of the image files
/// are remembered together with size, time of modification and inode of each file, and thus computed once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "datasets/formats/formats.h"
#include "datasets/io/file_descriptor.h"

namespace stillpoint::datasets {

/// Digest of a file that does not exist.
constexpr std::uint64_t kNoFileDigest = 0;

/// State and digest of the content of a file.
struct FileDigest {
  FileState state;
  std::uint64_t digest = kNoFileDigest;
  bool operator==(const FileDigest&) const = default;
};

/// Reads a whole file.
/// @return nullopt if it cannot be read, or changed while it was read
[[nodiscard]] std::optional<FileDigest> digest_of_file(const std::filesystem::path& file);

/// The remembered digests of one sequence folder.
class FileDigests {
 public:
  /// @param folder of the sequence; may be a symbolic link
  /// @param index_file a missing or damaged one has no entries
  FileDigests(const std::filesystem::path& folder, std::filesystem::path index_file);

  /// Digest of a file without reading it.
  /// @return `kNoFileDigest` if the file does not exist; nullopt if no digest of its present state is
  /// remembered
  [[nodiscard]] std::optional<std::uint64_t> find(const std::filesystem::path& file) const;

  void add(const std::filesystem::path& file, const FileDigest& digest);

  /// Writes the index file. A file that was modified less than 0.1 s ago is left out: it could be modified
  /// again without a change of its time, whose resolution is limited.
  /// @throws InputError if it cannot be written
  void save() const;

 private:
  [[nodiscard]] std::string name_of(const std::filesystem::path& file) const;

  std::filesystem::path folder_;
  std::filesystem::path index_file_;
  std::map<std::string, FileDigest> digests_;
};

/// The sequence folder that an index file belongs to; nullopt if the file is damaged.
[[nodiscard]] std::optional<std::filesystem::path> folder_of_digests(const std::filesystem::path& index_file);

/// The index file of a sequence folder in the folder of the cache.
[[nodiscard]] std::filesystem::path digests_file(const std::filesystem::path& cache,
                                                 const std::filesystem::path& sequence);

constexpr const char* kDigestsExtension = ".digests";
constexpr const char* kUnfinishedExtension = ".new";  ///< while an index file is written

/// Version of the decoding: of gray values, registration and depth. Increase it whenever `decode_frame`
/// returns other images for the same files.
constexpr std::uint64_t kDecodingVersion = 2;

/// Hash of the digests, the calibration by which images are decoded and registered, and the versions of
/// decoder and file format. Frame times and inertial data are not part of it: they are read from the sequence
/// in every run.
[[nodiscard]] std::uint64_t cache_key(const SequenceContent& content, std::span<const FrameDigest> frames);

/// The cache file of a key.
[[nodiscard]] std::filesystem::path frame_file(const std::filesystem::path& cache, std::uint64_t key);

}  // namespace stillpoint::datasets
