// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/mcap.h"

#include <algorithm>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "datasets/bags/messages.h"
#include "datasets/foxglove/messages.h"

namespace stillpoint::datasets {
namespace {

namespace mcap {

/// First and last bytes of a file.
constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::uint64_t kRecordHeadBytes = 9;  ///< opcode, length

enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

}  // namespace mcap

constexpr std::uint64_t kMessageHead = 22;          ///< channel, sequence number, log time, publish time
constexpr std::uint64_t kChunkHeadBytes = 4096;     ///< contains the fields of a chunk before its records
constexpr std::uint64_t kMaxFieldsBytes = 1 << 26;  ///< of a schema, channel or message index

/// The part of the file that is not compressed, as a chunk: positions in it are positions in the file.
constexpr std::uint32_t kWholeFile = 0;

struct RecordHead {
  std::uint8_t opcode = 0;
  std::uint64_t bytes = 0;
};

RecordHead parse_head(std::string_view head, const std::string& place) {
  ByteReader reader(head, place);
  const std::uint8_t opcode = reader.number<std::uint8_t>();
  return {.opcode = opcode, .bytes = reader.number<std::uint64_t>()};
}

Timestamp read_mcap_time(ByteReader& reader) {
  return {static_cast<std::int64_t>(reader.number<std::uint64_t>())};
}

struct Schema {
  std::string name;
  std::string definition;
};

/// Collects the index of a file in one pass over its records.
class McapIndexer {
 public:
  explicit McapIndexer(const ChunkReader& reader) : reader_(reader), place_(reader.file().path().string()) {
    index_.chunks.push_back(
        {.position = 0, .stored_bytes = reader.file().size(), .bytes = reader.file().size()});
  }

  [[nodiscard]] BagIndex run() {
    const ByteFile& file = reader_.file();
    std::uint64_t position = mcap::kMagic.size();
    bool complete = false;
    bool at_footer = false;
    closed_ = file.size() >= 2 * mcap::kMagic.size() &&
              file.read(file.size() - mcap::kMagic.size(), mcap::kMagic.size()) == mcap::kMagic;
    while (!at_footer && position + mcap::kRecordHeadBytes <= file.size()) {
      const RecordHead head = parse_head(file.read(position, mcap::kRecordHeadBytes), place_);
      const std::uint64_t data = position + mcap::kRecordHeadBytes;
      if (head.opcode == 0 || head.bytes > file.size() - data) break;  // 0: a file is enlarged by zeros
      at_footer = head.opcode == mcap::kFooter;
      complete |= at_footer || head.opcode == mcap::kDataEnd;
      if (!read([&] { add(head, position); })) break;
      position = data + head.bytes;
    }
    index_.complete = complete;
    if (!complete)
      index_.warnings.emplace_back(
          "is not complete: it ends without its end mark; the records before are read");
    static_cast<void>(read([this] { finish_chunk(); }));
    find_missing_channels();
    if (index_.messages.empty() && !complete)
      throw InputError(place_, "ends before its first message; copy or record it again");
    return std::move(index_);
  }

 private:
  /// Runs `action`, which reads a record or chunk. The last one of a file that was not closed may be damaged.
  /// @return false if it is
  template <class Action>
  [[nodiscard]] bool read(const Action& action) {
    try {
      action();
      return true;
    } catch (const InputError& error) {
      if (closed_) throw;
      index_.warnings.push_back("a record is damaged and was read in part (" + std::string(error.what()) +
                                ")");
      return false;
    }
  }

  [[nodiscard]] std::string fields_of(const RecordHead& head, std::uint64_t position) const {
    if (head.bytes > kMaxFieldsBytes)
      throw InputError(place_, "contains a record of impossible size; it is damaged, copy the file again");
    return reader_.file().read(position + mcap::kRecordHeadBytes, head.bytes);
  }

  void add(const RecordHead& head, std::uint64_t position) {
    switch (head.opcode) {
      case mcap::kSchema:
        add_schema(fields_of(head, position));
        break;
      case mcap::kChannel:
        add_channel(fields_of(head, position));
        break;
      case mcap::kMessage:
        add_message(
            reader_.file().read(position + mcap::kRecordHeadBytes, std::min(head.bytes, kMessageHead)),
            kWholeFile, position);
        break;
      case mcap::kChunk:
        finish_chunk();
        add_chunk(head, position + mcap::kRecordHeadBytes);
        break;
      case mcap::kMessageIndex:
        add_message_index(fields_of(head, position));
        break;
      default:
        break;  // attachments, metadata, and records of later versions
    }
  }

  void add_schema(std::string_view fields) {
    ByteReader reader(fields, place_);
    const std::uint16_t id = reader.number<std::uint16_t>();
    const std::string_view name = reader.text();
    const std::string_view encoding = reader.text();
    const std::string_view definition = reader.block();
    const bool is_text = encoding == "ros1msg" || encoding == "ros2msg";
    schemas_[id] = {.name = std::string(name), .definition = std::string(is_text ? definition : "")};
  }

  void add_channel(std::string_view fields) {
    ByteReader reader(fields, place_);
    const std::uint16_t id = reader.number<std::uint16_t>();
    const std::uint16_t schema_id = reader.number<std::uint16_t>();
    const std::string_view topic = reader.text();
    const std::string_view encoding = reader.text();
    BagConnection& connection = index_.connections[connection_index(id)];
    known_.insert(id);
    const Schema& schema = schemas_[schema_id];
    const bool is_pose = encoding == "protobuf" && schema.name == kPoseInFrameType;
    if (!connection.topic.empty() || (encoding != "ros1" && encoding != "cdr" && !is_pose)) return;
    connection = {.topic = std::string(topic),
                  .type = schema.name,
                  .definition = schema.definition,
                  .format = is_pose             ? WireFormat::kProtobuf
                            : encoding == "cdr" ? WireFormat::kCdr
                                                : WireFormat::kRos1};
  }

  std::uint32_t connection_index(std::uint16_t id) {
    const auto [entry, is_new] = ids_.emplace(id, static_cast<std::uint32_t>(index_.connections.size()));
    if (is_new) index_.connections.emplace_back();
    return entry->second;
  }

  /// @param head the first bytes of the record
  void add_message(std::string_view head, std::uint32_t chunk, std::uint64_t offset) {
    ByteReader reader(head, place_);
    const std::uint16_t channel = reader.number<std::uint16_t>();
    reader.skip(sizeof(std::uint32_t));
    index_.messages.push_back({.t = read_mcap_time(reader),
                               .connection = connection_index(channel),
                               .chunk = chunk,
                               .offset = offset});
  }

  void add_chunk(const RecordHead& head, std::uint64_t position) {
    const std::string fields = reader_.file().read(position, std::min(head.bytes, kChunkHeadBytes));
    ByteReader reader(fields, place_);
    reader.skip(2 * sizeof(std::uint64_t));  // times of the first and the last message
    BagChunk chunk;
    chunk.bytes = reader.number<std::uint64_t>();
    chunk.crc = reader.number<std::uint32_t>();
    const std::string name(reader.text());
    const std::optional<ChunkCompression> compression = compression_of(name);
    if (!compression)
      throw InputError(
          place_, "a chunk has the unknown compression \"" + name + "\"; convert it with `mcap compress`");
    chunk.compression = *compression;
    chunk.stored_bytes = reader.number<std::uint64_t>();
    chunk.position = position + reader.position();
    if (chunk.stored_bytes > head.bytes - reader.position())
      reader.fail("has a chunk that exceeds its record");
    if (chunk.compression == ChunkCompression::kNone && chunk.bytes != chunk.stored_bytes)
      reader.fail("has a chunk with contradicting sizes");
    index_.chunks.push_back(chunk);
    indexed_ = chunk.bytes == 0;
  }

  void add_message_index(std::string_view fields) {
    if (index_.chunks.size() == 1) return;  // of no chunk
    ByteReader reader(fields, place_);
    const std::uint32_t connection = connection_index(reader.number<std::uint16_t>());
    const std::string_view entries = reader.block();
    ByteReader entry(entries, place_);
    while (entry.remaining() > 0) {
      const Timestamp t = read_mcap_time(entry);
      index_.messages.push_back({.t = t,
                                 .connection = connection,
                                 .chunk = static_cast<std::uint32_t>(index_.chunks.size() - 1),
                                 .offset = entry.number<std::uint64_t>()});
    }
    indexed_ = true;
  }

  /// Reads the records in the chunk that was added last, unless index records have described it.
  void finish_chunk() {
    if (!indexed_) walk_chunk(static_cast<std::uint32_t>(index_.chunks.size() - 1), true);
    indexed_ = true;
  }

  /// @param with_messages false: schemas and channels only
  void walk_chunk(std::uint32_t chunk, bool with_messages) {
    const std::shared_ptr<const std::string> bytes = reader_.chunk_bytes(index_.chunks[chunk]);
    ByteReader reader(*bytes, place_);
    while (reader.remaining() > 0) {
      const std::uint64_t offset = reader.position();
      const RecordHead head = parse_head(reader.take(mcap::kRecordHeadBytes), place_);
      const std::string_view fields = reader.take(head.bytes);
      if (head.opcode == mcap::kSchema) add_schema(fields);
      if (head.opcode == mcap::kChannel) add_channel(fields);
      if (head.opcode == mcap::kMessage && with_messages) add_message(fields, chunk, offset);
    }
  }

  /// Channels are in the chunks, and not always in the summary. Drops the messages of other encodings.
  void find_missing_channels() {
    std::set<std::uint32_t> unknown;
    for (const auto& [id, connection] : ids_) {
      if (!known_.contains(id)) unknown.insert(connection);
    }
    std::set<std::uint32_t> chunks;
    for (const BagMessage& message : index_.messages) {
      if (unknown.contains(message.connection) && message.chunk != kWholeFile) chunks.insert(message.chunk);
    }
    for (const std::uint32_t chunk : chunks) {
      if (known_.size() < ids_.size()) static_cast<void>(read([&] { walk_chunk(chunk, false); }));
    }
    std::erase_if(index_.messages, [this](const BagMessage& message) {
      return index_.connections[message.connection].topic.empty();
    });
  }

  const ChunkReader& reader_;
  std::string place_;
  BagIndex index_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::uint32_t> ids_;  ///< number in the file to index
  std::set<std::uint16_t> known_;               ///< described channels
  bool closed_ = true;                          ///< whether the file ends as its recorder ends it
  bool indexed_ = true;                         ///< whether index records followed the last chunk
};

void require_magic(const ByteFile& file) {
  if (file.read(0, mcap::kMagic.size()) == mcap::kMagic) return;
  throw InputError(file.path().string(), "is not an MCAP file of version 0; copy the file again");
}

}  // namespace

McapFile::McapFile(const std::filesystem::path& file) : reader_(file) {
  require_magic(reader_.file());
  index_ = McapIndexer(reader_).run();
}

std::string McapFile::payload(const BagMessage& message, std::uint64_t max_bytes) const {
  const BagChunk& chunk = index_.chunks[message.chunk];
  const std::string place = reader_.file().path().string();
  const std::string bytes = reader_.read(chunk, message.offset, mcap::kRecordHeadBytes);
  const RecordHead head = parse_head(bytes, place);
  const std::uint64_t available = chunk.bytes - message.offset - mcap::kRecordHeadBytes;
  if (head.opcode != mcap::kMessage || head.bytes < kMessageHead || head.bytes > available)
    throw InputError(place, "its index points to no message; it is damaged, restore it with `mcap recover`");
  return reader_.read(chunk, message.offset + mcap::kRecordHeadBytes + kMessageHead,
                      std::min(max_bytes, head.bytes - kMessageHead));
}

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

McapWriter::McapWriter(const std::filesystem::path& path, ChunkCompression compression,
                       std::string_view profile)
    : file_(path), compression_(compression) {
  file_.append(mcap::kMagic);
  file_.append(record(mcap::kHeader, ByteWriter().text(profile).text("stillpoint").bytes()));
}

std::uint32_t McapWriter::add_connection(std::string_view topic, std::string_view type) {
  return add_channel({.topic = std::string(topic),
                      .message_encoding = "cdr",
                      .type = ros2_type(type),
                      .schema_encoding = "ros2msg",
                      .schema = definition_of(type, WireFormat::kCdr).text});
}

std::uint32_t McapWriter::add_channel(const McapChannel& channel) {
  const auto id = static_cast<std::uint16_t>(connections_.size());
  const auto schema = static_cast<std::uint16_t>(id + 1);  // 0 means none
  ByteWriter schema_fields;
  schema_fields.number(schema).text(channel.type).text(channel.schema_encoding).block(channel.schema);
  ByteWriter channel_fields;
  channel_fields.number(id).number(schema).text(channel.topic).text(channel.message_encoding).block("");
  connections_.push_back({.schema = record(mcap::kSchema, schema_fields.bytes()),
                          .channel = record(mcap::kChannel, channel_fields.bytes())});
  written_.push_back(false);
  counts_.push_back(0);
  return id;
}

void McapWriter::write(std::uint32_t connection, Timestamp t, std::string_view bytes) {
  if (!written_[connection]) {
    chunk_ += connections_[connection].schema + connections_[connection].channel;
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
  file_.flush();
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

std::string McapWriter::summary(std::uint64_t position) const {
  std::string records;
  ByteWriter offsets;
  const auto end_group = [&](mcap::Opcode opcode, std::size_t begin) {
    if (records.size() == begin) return;
    const std::uint64_t length = records.size() - begin;
    offsets.append(record(mcap::kSummaryOffset, ByteWriter()
                                                    .number(static_cast<std::uint8_t>(opcode))
                                                    .number(position + begin)
                                                    .number(length)
                                                    .bytes()));
  };
  for (const Connection& connection : connections_) records += connection.schema;
  end_group(mcap::kSchema, 0);
  std::size_t begin = records.size();
  for (const Connection& connection : connections_) records += connection.channel;
  end_group(mcap::kChannel, begin);
  begin = records.size();
  records += statistics_record();
  end_group(mcap::kStatistics, begin);
  begin = records.size();
  for (const std::string& index : chunk_indexes_) records += index;
  end_group(mcap::kChunkIndex, begin);
  const std::uint64_t offset_start = position + records.size();
  records += offsets.bytes();
  // The checksum covers the summary and the footer up to the checksum itself.
  ByteWriter footer;
  footer.number(static_cast<std::uint8_t>(mcap::kFooter)).number(std::uint64_t{20});
  footer.number(position).number(offset_start);
  records += footer.bytes();
  return records + ByteWriter().number(crc32_of(records)).bytes();
}

void McapWriter::finish() {
  finish_chunk();
  file_.append(record(mcap::kDataEnd, ByteWriter().number(std::uint32_t{0}).bytes()));
  file_.append(summary(file_.position()));
  file_.append(mcap::kMagic);
  file_.finish();
}

}  // namespace stillpoint::datasets
