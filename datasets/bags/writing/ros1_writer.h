// SPDX-License-Identifier: BSD-3-Clause
/// Writes ROS 1 bags, format 2.0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/bags/bag_index.h"
#include "datasets/bags/writing/output_file.h"

namespace stillpoint::datasets {

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
