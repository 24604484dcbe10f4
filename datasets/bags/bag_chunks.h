// SPDX-License-Identifier: BSD-3-Clause
/// The index of a bag (connections, chunks, and the position of each message), and access to its chunks:
/// compression, and reading of parts. The only component that depends on bzip2, LZ4 and zstd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/io/file_descriptor.h"

namespace stillpoint::datasets {

/// Serialization of messages: ROS 1, the Common Data Representation of OMG (ROS 2), or Protocol Buffers, of
/// which only poses are read (datasets/foxglove).
enum class WireFormat { kRos1, kCdr, kProtobuf };

/// Messages of one publisher on one topic. A topic may have several connections.
struct BagConnection {
  std::string topic;       ///< e.g. "/camera/color/image_raw"
  std::string type;        ///< of the messages, in the spelling of ROS 1, e.g. "sensor_msgs/Image"
  std::string definition;  ///< the fields of the type and of its parts; empty if the container has none
  WireFormat format = WireFormat::kRos1;
};

enum class ChunkCompression { kNone, kBz2, kLz4, kZstd };

/// A part of the file that contains records and may be compressed.
struct BagChunk {
  std::uint64_t position = 0;      ///< of the stored bytes in the file
  std::uint64_t stored_bytes = 0;  ///< in the file
  std::uint64_t bytes = 0;         ///< after decompression
  ChunkCompression compression = ChunkCompression::kNone;
  std::uint32_t crc = 0;  ///< CRC-32 of the decompressed bytes; 0 = unknown
};

/// Position of one message.
struct BagMessage {
  Timestamp t;                   ///< of the recording
  std::uint32_t connection = 0;  ///< index of its connection
  std::uint32_t chunk = 0;       ///< index of its chunk
  std::uint64_t offset = 0;      ///< of its record in the decompressed chunk; the row in a database
};

struct BagIndex {
  std::vector<BagConnection> connections;
  std::vector<BagChunk> chunks;  ///< empty for a database
  std::vector<BagMessage> messages;
  std::vector<std::string> warnings;  ///< repaired faults of the file, without its name
  bool complete = true;               ///< false: the file ends early, or was not closed
};

/// Largest size of a decompressed chunk.
inline constexpr std::uint64_t kMaxChunkBytes = 1'000'000'000;

/// Writers close a chunk that has reached this size, the default of rosbag; one message may be larger.
inline constexpr std::size_t kWrittenChunkBytes = std::size_t{768} * 1024;

/// The method with this name in a bag: none or "", bz2, lz4, zstd.
[[nodiscard]] std::optional<ChunkCompression> compression_of(std::string_view name);

/// Inverse of `compression_of`.
[[nodiscard]] std::string_view name_of(ChunkCompression compression);

/// Decompresses a chunk: a bzip2 stream, LZ4 frames, or zstd frames. The memory grows with the decompressed
/// bytes, not with the expected number.
/// @param bytes expected size after decompression
/// @param place for errors
/// @throws InputError if the chunk is damaged, larger than `kMaxChunkBytes`, or has another size
[[nodiscard]] std::string decompress_chunk(ChunkCompression compression, std::string_view stored,
                                           std::uint64_t bytes, const std::string& place);

/// Inverse of `decompress_chunk`. LZ4 frames have independent blocks, as the decoder of ROS 1 requires.
[[nodiscard]] std::string compress_chunk(ChunkCompression compression, std::string_view bytes);

/// Decompresses zstd frames of unknown size; otherwise like `decompress_chunk`.
[[nodiscard]] std::string decompress_zstd(std::string_view stored, const std::string& place);

/// CRC-32 of zlib, ISO 3309.
[[nodiscard]] std::uint32_t crc32_of(std::string_view bytes, std::uint32_t previous = 0);

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
