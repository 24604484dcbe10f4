// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/writing/ros1_writer.h"

#include <algorithm>
#include <initializer_list>

#include "core/base/error.h"
#include "datasets/bags/chunk_codec.h"
#include "datasets/bags/writing/byte_writer.h"
#include "datasets/bags/writing/serialize.h"

namespace stillpoint::datasets {
namespace {

constexpr std::string_view kFirstLine = "#ROSBAG V2.0\n";
constexpr std::size_t kBagHeaderBytes = 4096;  ///< header and padding
constexpr std::int64_t kMaxSeconds = UINT32_MAX;

template <class Number>
std::string field(std::string_view name, Number value) {
  const std::string number = ByteWriter().number(value).take();
  return ByteWriter().block(std::string(name) + "=" + number).take();
}

std::string text_field(std::string_view name, std::string_view value) {
  return ByteWriter().block(std::string(name) + "=" + std::string(value)).take();
}

std::string record(const std::string& header, std::string_view data) {
  return ByteWriter().block(header).block(data).take();
}

}  // namespace

Ros1Writer::Ros1Writer(const std::filesystem::path& path, ChunkCompression compression)
    : file_(path), path_(path.string()), compression_(compression) {
  file_.append(kFirstLine);
  file_.append(bag_header(0));
}

std::string Ros1Writer::bag_header(std::uint64_t index_position) const {
  const std::string header = field("chunk_count", static_cast<std::uint32_t>(chunks_.size())) +
                             field("conn_count", static_cast<std::uint32_t>(connections_.size())) +
                             field("index_pos", index_position) + field("op", std::uint8_t{3});
  return record(header, std::string(kBagHeaderBytes - header.size(), ' '));
}

std::uint32_t Ros1Writer::add_connection(std::string_view topic, std::string_view type) {
  const auto id = static_cast<std::uint32_t>(connections_.size());
  const MessageDefinition definition = definition_of(type, WireFormat::kRos1);
  const std::string header = field("conn", id) + field("op", std::uint8_t{7}) + text_field("topic", topic);
  const std::string data = text_field("topic", topic) + text_field("type", type) +
                           text_field("md5sum", definition.md5) +
                           text_field("message_definition", definition.text);
  connections_.push_back(record(header, data));
  written_.push_back(false);
  return id;
}

void Ros1Writer::write(std::uint32_t connection, Timestamp t, std::string_view bytes) {
  if (t.ns < 0 || t.ns / kSecond_ns > kMaxSeconds)
    throw InputError(path_, "bags of ROS 1 have times from 0 to 2^32 s, not " + std::to_string(t.ns) +
                                " ns; write an .mcap file");
  if (!written_[connection]) {
    chunk_ += connections_[connection];
    written_[connection] = true;
  }
  index_[connection].push_back({.t = t, .offset = static_cast<std::uint32_t>(chunk_.size())});
  const std::string time = ByteWriter().time(t).take();
  chunk_ +=
      record(field("conn", connection) + field("op", std::uint8_t{2}) + text_field("time", time), bytes);
  if (chunk_.size() >= kWrittenChunkBytes) finish_chunk();
}

void Ros1Writer::finish_chunk() {
  if (chunk_.empty()) return;
  ChunkInfo info{.position = file_.position(),
                 .first = index_.begin()->second.front().t,
                 .last = index_.begin()->second.front().t,
                 .counts = {}};
  const std::string header = text_field("compression", name_of(compression_)) + field("op", std::uint8_t{5}) +
                             field("size", static_cast<std::uint32_t>(chunk_.size()));
  file_.append(record(header, compress_chunk(compression_, chunk_)));
  for (const auto& [connection, entries] : index_) {
    ByteWriter data;
    for (const IndexEntry& entry : entries) {
      data.time(entry.t).number(entry.offset);
      info.first = std::min(info.first, entry.t);
      info.last = std::max(info.last, entry.t);
    }
    const auto count = static_cast<std::uint32_t>(entries.size());
    info.counts[connection] = count;
    file_.append(record(field("conn", connection) + field("count", count) + field("op", std::uint8_t{4}) +
                            field("ver", std::uint32_t{1}),
                        data.bytes()));
  }
  chunks_.push_back(std::move(info));
  chunk_.clear();
  index_.clear();
}

std::string Ros1Writer::chunk_info_record(const ChunkInfo& info) {
  ByteWriter data;
  for (const auto& [connection, count] : info.counts) data.number(connection).number(count);
  return record(
      field("chunk_pos", info.position) + field("count", static_cast<std::uint32_t>(info.counts.size())) +
          text_field("end_time", ByteWriter().time(info.last).take()) + field("op", std::uint8_t{6}) +
          text_field("start_time", ByteWriter().time(info.first).take()) + field("ver", std::uint32_t{1}),
      data.bytes());
}

void Ros1Writer::finish() {
  finish_chunk();
  const std::uint64_t index_position = file_.position();
  for (const std::string& connection : connections_) file_.append(connection);
  for (const ChunkInfo& info : chunks_) file_.append(chunk_info_record(info));
  file_.overwrite(kFirstLine.size(), bag_header(index_position));
  file_.finish();
}

}  // namespace stillpoint::datasets
