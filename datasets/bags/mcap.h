// SPDX-License-Identifier: BSD-3-Clause
/// Reads MCAP files with messages of ROS 1 or ROS 2, and writes those with messages of ROS 2. A file consists
/// of records: opcode (1 byte), length (8 bytes, little endian), fields. Specification: mcap.dev/spec.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/bags/bag_chunks.h"
#include "datasets/bags/byte_stream.h"

namespace stillpoint::datasets {

/// Reads a part of each record of the data section to index the file. The summary and the index records after
/// the chunks are not required: a chunk without them is decompressed. A file that was not closed is read up
/// to its last complete record, with a warning. Channels of other encodings than those of ROS are ignored.
class McapFile {
 public:
  /// @throws InputError if the file is no MCAP file, or is damaged
  explicit McapFile(const std::filesystem::path& file);

  [[nodiscard]] const BagIndex& index() const { return index_; }

  /// The serialized message, or its first `max_bytes`. Thread-safe.
  /// @throws InputError if the file is damaged
  [[nodiscard]] std::string payload(
      const BagMessage& message, std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max()) const;

 private:
  ChunkReader reader_;
  BagIndex index_;
};

/// Writes chunks of about 768 kB with checksums and message indexes, and a summary.
class McapWriter {
 public:
  McapWriter(const std::filesystem::path& path, ChunkCompression compression);

  [[nodiscard]] std::uint32_t add_connection(std::string_view topic, std::string_view type);
  void write(std::uint32_t connection, Timestamp t, std::string_view bytes);
  void finish();

 private:
  void finish_chunk();
  [[nodiscard]] std::string statistics_record() const;

  OutputFile file_;
  ChunkCompression compression_;
  std::vector<std::string> connections_;  ///< schema and channel records
  std::vector<bool> written_;             ///< connections that are in a chunk
  std::vector<std::uint64_t> counts_;     ///< messages of each connection
  std::uint32_t sequence_ = 0;
  std::string chunk_;
  std::map<std::uint16_t, std::string> index_;  ///< entries of the chunk
  Timestamp chunk_first_, chunk_last_;
  Timestamp first_, last_;
  std::vector<std::string> chunk_indexes_;  ///< records
};

}  // namespace stillpoint::datasets
