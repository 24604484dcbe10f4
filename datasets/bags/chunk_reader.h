// SPDX-License-Identifier: BSD-3-Clause
/// Reads parts of a file, and of its compressed chunks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "datasets/bags/bag_index.h"
#include "datasets/io/file_descriptor.h"

namespace stillpoint::datasets {

/// A file of which any part can be read. Thread-safe.
class ByteFile {
 public:
  /// @throws InputError if it is no regular file or cannot be opened
  explicit ByteFile(std::filesystem::path path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// The bytes from `position` on; fewer than `count` at the end of the file.
  /// @throws InputError if they cannot be read
  [[nodiscard]] std::string read(std::uint64_t position, std::uint64_t count) const;

 private:
  std::filesystem::path path_;
  FileDescriptor descriptor_;
  std::uint64_t size_ = 0;
};

/// Keeps the chunks that were decompressed last in memory. Thread-safe.
class ChunkReader {
 public:
  explicit ChunkReader(std::filesystem::path path) : file_(std::move(path)) {}

  [[nodiscard]] const ByteFile& file() const { return file_; }

  /// Bytes of a chunk from `offset` on; fewer than `count` at its end. Of a chunk without compression, only
  /// these bytes are read.
  /// @throws InputError if the chunk is damaged
  [[nodiscard]] std::string read(const BagChunk& chunk, std::uint64_t offset, std::uint64_t count) const;

  /// The whole decompressed chunk.
  [[nodiscard]] std::shared_ptr<const std::string> chunk_bytes(const BagChunk& chunk) const;

 private:
  struct Decompressed {
    std::uint64_t position = 0;
    std::shared_ptr<const std::string> bytes;
  };

  [[nodiscard]] std::shared_ptr<const std::string> find(std::uint64_t position) const;
  void keep(const Decompressed& chunk) const;

  ByteFile file_;
  mutable std::mutex mutex_;                ///< guards the chunks
  mutable std::list<Decompressed> chunks_;  ///< the most recently used first
};

}  // namespace stillpoint::datasets
