// SPDX-License-Identifier: BSD-3-Clause
/// What a bag contains, without its messages: connections, chunks, and the position of each message.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/timestamp.h"

namespace stillpoint::datasets {

/// Serialization of messages: ROS 1, or the Common Data Representation of OMG (ROS 2).
enum class WireFormat { kRos1, kCdr };

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

}  // namespace stillpoint::datasets
