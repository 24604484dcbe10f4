// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/mcap_file.h"

#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "datasets/bags/byte_reader.h"
#include "datasets/bags/chunk_codec.h"
#include "datasets/bags/mcap_records.h"

namespace stillpoint::datasets {
namespace {

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
    while (!at_footer && position + mcap::kRecordHeadBytes <= file.size()) {
      const RecordHead head = parse_head(file.read(position, mcap::kRecordHeadBytes), place_);
      const std::uint64_t data = position + mcap::kRecordHeadBytes;
      if (head.bytes > file.size() - data) break;
      at_footer = head.opcode == mcap::kFooter;
      complete |= at_footer || head.opcode == mcap::kDataEnd;
      add(head, position);
      position = data + head.bytes;
    }
    index_.complete = complete;
    if (!complete)
      index_.warnings.emplace_back(
          "is not complete: it ends without its end mark; the records before are read");
    finish_chunk();
    find_missing_channels();
    return std::move(index_);
  }

 private:
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
    if (!connection.topic.empty() || (encoding != "ros1" && encoding != "cdr")) return;
    const Schema& schema = schemas_[schema_id];
    connection = {.topic = std::string(topic),
                  .type = schema.name,
                  .definition = schema.definition,
                  .format = encoding == "cdr" ? WireFormat::kCdr : WireFormat::kRos1};
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
      if (known_.size() < ids_.size()) walk_chunk(chunk, false);
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

}  // namespace stillpoint::datasets
