// SPDX-License-Identifier: BSD-3-Clause
/// Writes MCAP files with messages of ROS 2.
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
