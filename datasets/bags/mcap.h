// SPDX-License-Identifier: BSD-3-Clause
/// Reads MCAP files with messages of ROS 1 or ROS 2, or poses of Foxglove, and writes files with any
/// messages. A file consists of records: opcode (1 byte), length (8 bytes, little endian), fields.
/// Specification: mcap.dev/spec.
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
#include "datasets/io/byte_stream.h"

namespace stillpoint::datasets {

/// Reads a part of each record of the data section to index the file. The summary and the index records after
/// the chunks are not required: a chunk without them is decompressed. A file that was not closed is read up
/// to its last complete record, with a warning. Channels of other encodings than those of ROS are ignored,
/// but for the type foxglove.PoseInFrame in Protocol Buffers.
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

/// How the messages of a topic are encoded, and their schema.
struct McapChannel {
  std::string topic;
  std::string message_encoding;  ///< e.g. "cdr", "protobuf"
  std::string type;              ///< name of the schema
  std::string schema_encoding;   ///< e.g. "ros2msg", "protobuf"
  std::string schema;
};

/// Writes chunks of about 768 kB with checksums and message indexes, and a summary with a checksum and
/// offsets. A process that is killed leaves FILE.part with all complete chunks, which readers accept.
class McapWriter {
 public:
  /// @param profile of the messages: "ros2", or empty for others
  McapWriter(const std::filesystem::path& path, ChunkCompression compression,
             std::string_view profile = "ros2");

  /// A topic with messages of ROS 2, in the spelling of ROS 1.
  [[nodiscard]] std::uint32_t add_connection(std::string_view topic, std::string_view type);

  [[nodiscard]] std::uint32_t add_channel(const McapChannel& channel);

  /// @param t not negative; stamps need not be in order
  void write(std::uint32_t connection, Timestamp t, std::string_view bytes);
  void finish();

 private:
  void finish_chunk();
  [[nodiscard]] std::string statistics_record() const;
  [[nodiscard]] std::string summary(std::uint64_t position) const;

  /// Schema and channel records of a topic.
  struct Connection {
    std::string schema;
    std::string channel;
  };

  OutputFile file_;
  ChunkCompression compression_;
  std::vector<Connection> connections_;
  std::vector<bool> written_;          ///< connections that are in a chunk
  std::vector<std::uint64_t> counts_;  ///< messages of each connection
  std::uint32_t sequence_ = 0;
  std::string chunk_;
  std::map<std::uint16_t, std::string> index_;  ///< entries of the chunk
  Timestamp chunk_first_, chunk_last_;
  Timestamp first_, last_;
  std::vector<std::string> chunk_indexes_;  ///< records
};

}  // namespace stillpoint::datasets
