// SPDX-License-Identifier: BSD-3-Clause
/// Reads and writes bags of all containers: ROS 1 (.bag), MCAP (.mcap), SQLite (.db3), and the folders of
/// rosbag2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "datasets/bags/bag_chunks.h"
#include "datasets/bags/mcap.h"
#include "datasets/bags/ros1_bag.h"
#include "datasets/bags/rosbag2.h"

namespace stillpoint::datasets {

/// One message of an opened bag.
struct MessageReference {
  BagMessage message;      ///< `message.connection` is an index of `BagFile::connections`
  std::uint32_t file = 0;  ///< of the bag
};

/// An opened bag. Memory: 32 bytes per message and a few decompressed chunks.
class BagFile {
 public:
  /// @throws InputError if the path is no bag or a file of it is damaged
  explicit BagFile(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::vector<BagConnection>& connections() const { return connections_; }

  /// All messages in the order of their recording times.
  [[nodiscard]] const std::vector<MessageReference>& messages() const { return messages_; }

  /// Repaired faults, as "FILE: FAULT".
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// Whether no file ends early; a bag that was recorded, but not closed, is complete if no record is cut
  /// off.
  [[nodiscard]] bool is_complete() const { return complete_; }

  /// The connection of a message.
  [[nodiscard]] const BagConnection& connection(const MessageReference& reference) const {
    return connections_[reference.message.connection];
  }

  /// The serialized message, or its first `max_bytes`. Thread-safe.
  /// @throws InputError if the file is damaged
  [[nodiscard]] std::string payload(
      const MessageReference& reference,
      std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max()) const;

  /// Location of a message for errors, e.g. "a.bag:/imu at 12.345678900 s".
  [[nodiscard]] std::string place(const MessageReference& reference) const;

  /// Changes when a file of the bag is written: a hash of their sizes, times of modification and inodes.
  [[nodiscard]] std::uint64_t state() const;

 private:
  using Container = std::variant<Ros1Bag, McapFile, Rosbag2Database>;
  struct File {
    std::filesystem::path path;
    std::unique_ptr<Container> container;
    std::uint32_t first_connection = 0;
  };

  void add_file(const std::filesystem::path& path);

  std::filesystem::path path_;
  std::vector<File> files_;
  std::vector<BagConnection> connections_;
  std::vector<MessageReference> messages_;
  std::vector<std::string> warnings_;
  bool complete_ = true;
};

/// The messages in the order of their bytes in the files, so that each chunk is decompressed once.
[[nodiscard]] std::vector<MessageReference> in_file_order(std::span<const MessageReference> messages);

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
