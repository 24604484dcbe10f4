// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/writing/bag_writer.h"

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

void require_compression(const std::filesystem::path& path, bool supported, const char* supported_names) {
  if (!supported)
    throw InputError(path.string(),
                     std::string("this container has no such compression; use one of: ") + supported_names);
}

}  // namespace

BagWriter::BagWriter(const std::filesystem::path& path, ChunkCompression compression) {
  if (path.extension() == ".bag") {
    require_compression(path, compression != ChunkCompression::kZstd, "none, bz2, lz4");
    writer_ = std::make_unique<Ros1Writer>(path, compression);
  } else if (path.extension() == ".mcap") {
    require_compression(path, compression != ChunkCompression::kBz2, "none, lz4, zstd");
    writer_ = std::make_unique<McapWriter>(path, compression);
  } else {
    require_compression(path, compression == ChunkCompression::kNone, "none");
    writer_ = std::make_unique<Rosbag2Writer>(path);
  }
}

WireFormat BagWriter::format() const {
  return std::holds_alternative<std::unique_ptr<Ros1Writer>>(writer_) ? WireFormat::kRos1 : WireFormat::kCdr;
}

std::uint32_t BagWriter::add_connection(std::string_view topic, std::string_view type) {
  return std::visit([&](auto& writer) { return writer->add_connection(topic, type); }, writer_);
}

void BagWriter::write(std::uint32_t connection, Timestamp t, std::string_view bytes) {
  std::visit([&](auto& writer) { writer->write(connection, t, bytes); }, writer_);
}

void BagWriter::finish() {
  std::visit([](auto& writer) { writer->finish(); }, writer_);
}

}  // namespace stillpoint::datasets
