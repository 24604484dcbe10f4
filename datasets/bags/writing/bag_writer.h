// SPDX-License-Identifier: BSD-3-Clause
/// Writes bags of all containers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <variant>

#include "datasets/bags/writing/mcap_writer.h"
#include "datasets/bags/writing/ros1_writer.h"
#include "datasets/bags/writing/rosbag2_writer.h"

namespace stillpoint::datasets {

/// A bag whose container follows from its name: FILE.bag is one of ROS 1, FILE.mcap is MCAP, any other name
/// is a folder of rosbag2 with an SQLite database. It gets its name when it is complete.
class BagWriter {
 public:
  /// @param compression of chunks: none, bz2 or lz4 (ROS 1), none, lz4 or zstd (MCAP), none (SQLite)
  /// @throws InputError if the bag cannot be created, or the container does not have the compression
  BagWriter(const std::filesystem::path& path, ChunkCompression compression);

  /// Of the messages.
  [[nodiscard]] WireFormat format() const;

  /// @param type in the spelling of ROS 1, one of `definition_of`
  /// @return the connection of messages
  [[nodiscard]] std::uint32_t add_connection(std::string_view topic, std::string_view type);

  /// @param bytes of the message in `format()`
  /// @throws InputError if the time is outside of the range of the container: ROS 1 has no negative times
  void write(std::uint32_t connection, Timestamp t, std::string_view bytes);

  /// @throws InputError if the bag could not be written completely
  void finish();

 private:
  std::variant<std::unique_ptr<Ros1Writer>, std::unique_ptr<McapWriter>, std::unique_ptr<Rosbag2Writer>>
      writer_;
};

}  // namespace stillpoint::datasets
