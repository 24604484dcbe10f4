// SPDX-License-Identifier: BSD-3-Clause
/// ROS 1 bags, format 2.0 (wiki.ros.org/Bags/Format/2.0).
#pragma once

#include <filesystem>
#include <limits>
#include <string>

#include "datasets/bags/bag_index.h"
#include "datasets/bags/chunk_reader.h"

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

}  // namespace stillpoint::datasets
