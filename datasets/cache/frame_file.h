// SPDX-License-Identifier: BSD-3-Clause
/// The cache file of one sequence: compressed frames in the order in which they were decoded.
///
///   header   magic, version, image size, name of the sequence, checksum
///   blocks   frame number, sizes, flags, checksum; compressed gray image; compressed depth image
///   index    place of the block of each frame
///   footer   place and length of the index, checksum, magic
///
/// A file is written under a temporary name and renamed when it is complete. Nothing is synced to disk: what
/// a power failure loses or damages is found by the checksums. Integers are little-endian, checksums are
/// XXH64.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/cache/frame_codec.h"
#include "datasets/io/file_descriptor.h"

namespace stillpoint::datasets {

/// Part of the key of a file: files of other versions are never opened.
constexpr std::uint32_t kFrameFileVersion = 1;

/// What the header of a file contains.
struct FrameFileInfo {
  std::string sequence;  ///< name; shortened to 107 bytes
  int width = 0;
  int height = 0;
};

/// Where a block is; 0 bytes: the frame could not be decoded when the file was written.
struct BlockPlace {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// Reads by `pread`, not by mapping: a truncated file is an error of one read, not a signal. Thread-safe.
class FrameFileReader {
 public:
  /// Reads header and index.
  /// @throws InputError if the file cannot be read, is truncated or damaged
  explicit FrameFileReader(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const FrameFileInfo& info() const { return info_; }
  [[nodiscard]] std::size_t frames() const { return index_.size(); }

  /// Whether the file contains the frame.
  [[nodiscard]] bool contains(std::size_t index) const { return index < frames() && index_[index].bytes > 0; }

  /// @param index of a contained frame
  /// @return nullopt if the block is damaged, or the file was truncated meanwhile
  [[nodiscard]] std::optional<PackedFrame> read(std::size_t index) const;

  /// Sets the time of the last use, which determines what is removed first.
  void mark_used() const;

 private:
  std::filesystem::path file_;
  FileDescriptor descriptor_;
  FrameFileInfo info_;
  std::vector<BlockPlace> index_;
};

/// Writes one file; not thread-safe.
class FrameFileWriter {
 public:
  /// Called before each write with the number of bytes; throws InputError if there is no space for them.
  using RequireSpace = std::function<void(std::uint64_t bytes)>;

  /// Creates the file, or takes over what a killed process left, and locks it until destruction.
  /// @return null if another process is writing the file
  /// @throws InputError if it cannot be created
  [[nodiscard]] static std::unique_ptr<FrameFileWriter> create(const std::filesystem::path& partial,
                                                               const FrameFileInfo& info,
                                                               RequireSpace require_space);
  /// Removes the file unless it was finished.
  ~FrameFileWriter();
  FrameFileWriter(const FrameFileWriter&) = delete;
  FrameFileWriter& operator=(const FrameFileWriter&) = delete;

  /// Appends a frame, in any order of frames, each once.
  /// @throws InputError if it cannot be written, e.g. because the disk is full
  void append(std::size_t index, const PackedFrame& frame);

  /// Records that the frame cannot be decoded.
  void append_unreadable(std::size_t index);

  [[nodiscard]] bool contains(std::size_t index) const { return index < known_.size() && known_[index]; }
  [[nodiscard]] std::size_t frames() const { return recorded_; }  ///< number of appended frames

  /// Writes the index and renames the file, replacing an older one.
  /// @throws InputError as `append`
  void finish(const std::filesystem::path& file);

 private:
  FrameFileWriter(std::filesystem::path partial, FileDescriptor descriptor, RequireSpace require_space);
  void write(const std::string& bytes);
  void record(std::size_t index, BlockPlace place);

  std::filesystem::path partial_;
  FileDescriptor descriptor_;
  RequireSpace require_space_;
  std::uint64_t end_ = 0;  ///< bytes written
  std::vector<BlockPlace> index_;
  std::vector<bool> known_;  ///< per frame of the index
  std::size_t recorded_ = 0;
  bool finished_ = false;
};

/// Removes files of writers that no longer exist. Files that are being written are locked and remain.
void remove_abandoned_files(const std::filesystem::path& folder);

/// Name extensions of the two kinds of files.
constexpr const char* kFrameFileExtension = ".frames";
constexpr const char* kPartialExtension = ".partial";

}  // namespace stillpoint::datasets
