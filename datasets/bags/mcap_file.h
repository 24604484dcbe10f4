// SPDX-License-Identifier: BSD-3-Clause
/// MCAP files (mcap.dev/spec) with messages of ROS 1 or ROS 2.
#pragma once

#include <filesystem>
#include <limits>
#include <string>

#include "datasets/bags/bag_index.h"
#include "datasets/bags/chunk_reader.h"

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

}  // namespace stillpoint::datasets
