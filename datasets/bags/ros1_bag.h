// SPDX-License-Identifier: BSD-3-Clause
/// Reads and writes ROS 1 bags, format 2.0 (wiki.ros.org/Bags/Format/2.0).
#pragma once

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

/// Reads a part of each record to index the file. Neither the index at its end nor the index records after
/// the chunks are required: a chunk without them is decompressed. A file that was not closed is read up to
/// its last complete chunk, with a warning.
class Ros1Bag {
 public:
  /// @throws InputError if the file is no bag of format 2.0, is encrypted, or is damaged
  explicit Ros1Bag(const std::filesystem::path& file);

  [[nodiscard]] const BagIndex& index() const { return index_; }

  /// The serialized message, or its first `max_bytes`. Thread-safe.
  /// @throws InputError if the file is damaged
  [[nodiscard]] std::string payload(
      const BagMessage& message, std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max()) const;

 private:
  ChunkReader reader_;
  BagIndex index_;
};

/// Writes chunks of about 768 kB, as rosbag does, with all indexes.
class Ros1Writer {
 public:
  Ros1Writer(const std::filesystem::path& path, ChunkCompression compression);

  [[nodiscard]] std::uint32_t add_connection(std::string_view topic, std::string_view type);
  void write(std::uint32_t connection, Timestamp t, std::string_view bytes);
  void finish();

 private:
  struct IndexEntry {
    Timestamp t;
    std::uint32_t offset = 0;
  };
  struct ChunkInfo {
    std::uint64_t position = 0;
    Timestamp first;
    Timestamp last;
    std::map<std::uint32_t, std::uint32_t> counts;  ///< messages of each connection
  };

  void finish_chunk();
  [[nodiscard]] std::string bag_header(std::uint64_t index_position) const;
  [[nodiscard]] static std::string chunk_info_record(const ChunkInfo& info);

  OutputFile file_;
  std::string path_;
  ChunkCompression compression_;
  std::vector<std::string> connections_;  ///< records
  std::vector<bool> written_;             ///< connections that are in a chunk
  std::string chunk_;
  std::map<std::uint32_t, std::vector<IndexEntry>> index_;  ///< of the chunk
  std::vector<ChunkInfo> chunks_;
};

}  // namespace stillpoint::datasets
