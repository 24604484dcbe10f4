// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/writing/mcap_writer.h"

#include <algorithm>

#include "datasets/bags/chunk_codec.h"
#include "datasets/bags/mcap_records.h"
#include "datasets/bags/writing/byte_writer.h"
#include "datasets/bags/writing/serialize.h"

namespace stillpoint::datasets {
namespace {

std::string record(mcap::Opcode opcode, std::string_view fields) {
  ByteWriter writer;
  writer.number(static_cast<std::uint8_t>(opcode)).number(std::uint64_t{fields.size()}).append(fields);
  return writer.take();
}

std::uint64_t time_of(Timestamp t) { return static_cast<std::uint64_t>(t.ns); }

/// MCAP has an empty name for no compression.
std::string_view mcap_name_of(ChunkCompression compression) {
  return compression == ChunkCompression::kNone ? "" : name_of(compression);
}

/// "sensor_msgs/msg/Image" of "sensor_msgs/Image".
std::string ros2_type(std::string_view type) {
  const std::size_t slash = type.find('/');
  return std::string(type.substr(0, slash)) + "/msg" + std::string(type.substr(slash));
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, ChunkCompression compression)
    : file_(path), compression_(compression) {
  file_.append(mcap::kMagic);
  file_.append(record(mcap::kHeader, ByteWriter().text("ros2").text("stillpoint").bytes()));
}

std::uint32_t McapWriter::add_connection(std::string_view topic, std::string_view type) {
  const auto id = static_cast<std::uint16_t>(connections_.size());
  const auto schema = static_cast<std::uint16_t>(id + 1);  // 0 means none
  ByteWriter schema_fields;
  schema_fields.number(schema)
      .text(ros2_type(type))
      .text("ros2msg")
      .block(definition_of(type, WireFormat::kCdr).text);
  ByteWriter channel_fields;
  channel_fields.number(id).number(schema).text(topic).text("cdr").block("");
  connections_.push_back(record(mcap::kSchema, schema_fields.bytes()) +
                         record(mcap::kChannel, channel_fields.bytes()));
  written_.push_back(false);
  counts_.push_back(0);
  return id;
}

void McapWriter::write(std::uint32_t connection, Timestamp t, std::string_view bytes) {
  if (!written_[connection]) {
    chunk_ += connections_[connection];
    written_[connection] = true;
  }
  if (index_.empty()) chunk_first_ = chunk_last_ = t;
  chunk_first_ = std::min(chunk_first_, t);
  chunk_last_ = std::max(chunk_last_, t);
  const auto channel = static_cast<std::uint16_t>(connection);
  index_[channel] += ByteWriter().number(time_of(t)).number(std::uint64_t{chunk_.size()}).bytes();
  ByteWriter fields;
  fields.number(channel).number(sequence_++).number(time_of(t)).number(time_of(t)).append(bytes);
  chunk_ += record(mcap::kMessage, fields.bytes());
  ++counts_[connection];
  if (chunk_.size() >= kWrittenChunkBytes) finish_chunk();
}

void McapWriter::finish_chunk() {
  if (index_.empty()) return;
  const std::uint64_t position = file_.position();
  const std::string stored = compress_chunk(compression_, chunk_);
  ByteWriter fields;
  fields.number(time_of(chunk_first_)).number(time_of(chunk_last_)).number(std::uint64_t{chunk_.size()});
  fields.number(crc32_of(chunk_))
      .text(mcap_name_of(compression_))
      .number(std::uint64_t{stored.size()})
      .append(stored);
  file_.append(record(mcap::kChunk, fields.bytes()));
  const std::uint64_t end = file_.position();
  ByteWriter offsets;
  for (const auto& [channel, entries] : index_) {
    offsets.number(channel).number(file_.position());
    file_.append(record(mcap::kMessageIndex, ByteWriter().number(channel).block(entries).bytes()));
  }
  ByteWriter index;
  index.number(time_of(chunk_first_)).number(time_of(chunk_last_)).number(position).number(end - position);
  index.block(offsets.bytes()).number(file_.position() - end).text(mcap_name_of(compression_));
  index.number(std::uint64_t{stored.size()}).number(std::uint64_t{chunk_.size()});
  first_ = chunk_indexes_.empty() ? chunk_first_ : std::min(first_, chunk_first_);
  last_ = chunk_indexes_.empty() ? chunk_last_ : std::max(last_, chunk_last_);
  chunk_indexes_.push_back(record(mcap::kChunkIndex, index.bytes()));
  chunk_.clear();
  index_.clear();
}

std::string McapWriter::statistics_record() const {
  ByteWriter fields;
  const auto connections = static_cast<std::uint32_t>(connections_.size());
  fields.number(std::uint64_t{sequence_}).number(static_cast<std::uint16_t>(connections)).number(connections);
  fields.number(std::uint32_t{0}).number(std::uint32_t{0});  // attachments, metadata
  fields.number(static_cast<std::uint32_t>(chunk_indexes_.size()))
      .number(time_of(first_))
      .number(time_of(last_));
  ByteWriter counts;
  for (std::size_t i = 0; i < counts_.size(); ++i)
    counts.number(static_cast<std::uint16_t>(i)).number(counts_[i]);
  return record(mcap::kStatistics, fields.block(counts.bytes()).bytes());
}

void McapWriter::finish() {
  finish_chunk();
  file_.append(record(mcap::kDataEnd, ByteWriter().number(std::uint32_t{0}).bytes()));
  const std::uint64_t summary = file_.position();
  for (const std::string& connection : connections_) file_.append(connection);
  file_.append(statistics_record());
  for (const std::string& index : chunk_indexes_) file_.append(index);
  // No summary offsets, no checksum of the summary.
  file_.append(record(
      mcap::kFooter, ByteWriter().number(summary).number(std::uint64_t{0}).number(std::uint32_t{0}).bytes()));
  file_.append(mcap::kMagic);
  file_.finish();
}

}  // namespace stillpoint::datasets
