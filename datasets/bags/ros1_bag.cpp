// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/ros1_bag.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "datasets/bags/messages.h"

namespace stillpoint::datasets {
namespace {

constexpr std::string_view kVersion2 = "#ROSBAG V2.0\n";
constexpr std::uint64_t kHeadBytes = 4096;          ///< read at once; longer headers are read again
constexpr std::uint64_t kMaxHeaderBytes = 1 << 24;  ///< fields of a record, without its data
constexpr std::uint64_t kIndexEntryBytes = 12;      ///< time and offset

/// Values of the field "op".
enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kIndexData = 4, kChunk = 5, kConnection = 7 };

/// Fields `name=value` of a record header or of the data of a connection.
std::map<std::string, std::string, std::less<>> parse_fields(std::string_view header,
                                                             const std::string& place) {
  std::map<std::string, std::string, std::less<>> fields;
  ByteReader reader(header, place);
  while (reader.remaining() > 0) {
    const std::string_view field = reader.block();
    const std::size_t separator = field.find('=');
    if (separator == std::string_view::npos) reader.fail("has a record field without \"=\"");
    fields.emplace(field.substr(0, separator), field.substr(separator + 1));
  }
  return fields;
}

/// Fields of a record, and where its data are.
struct Record {
  std::map<std::string, std::string, std::less<>> fields;
  std::uint64_t data_offset = 0;
  std::uint64_t data_bytes = 0;

  [[nodiscard]] std::uint64_t end() const { return data_offset + data_bytes; }

  template <class Number>
  [[nodiscard]] Number number(std::string_view name, const std::string& place) const {
    return ByteReader(text(name, place), place).number<Number>();
  }

  [[nodiscard]] std::string text(std::string_view name, const std::string& place) const {
    const auto found = fields.find(name);
    if (found == fields.end())
      throw InputError(
          place, "a record has no field \"" + std::string(name) + "\"; it is damaged, copy the file again");
    return found->second;
  }
};

/// Time stamps of ROS 1: seconds, then nanoseconds.
Timestamp read_ros1_time(ByteReader& reader) {
  const std::int64_t seconds = reader.number<std::uint32_t>();
  return {seconds * 1'000'000'000 + reader.number<std::uint32_t>()};
}

/// The record at `offset`.
/// @param read (offset, count) returns bytes, fewer at the end
/// @return nullopt if the bytes end within its header
template <class Read>
std::optional<Record> record_at(std::uint64_t offset, const Read& read, const std::string& place) {
  std::string head = read(offset, kHeadBytes);
  if (head.size() < sizeof(std::uint32_t)) return std::nullopt;
  const std::uint64_t header_bytes = ByteReader(head, place).number<std::uint32_t>();
  if (header_bytes > kMaxHeaderBytes)
    throw InputError(place, "contains no record at byte " + std::to_string(offset) +
                                "; it is damaged, copy the file again");
  const std::uint64_t head_bytes = header_bytes + 2 * sizeof(std::uint32_t);
  if (head.size() < head_bytes) head = read(offset, head_bytes);
  if (head.size() < head_bytes) return std::nullopt;
  ByteReader reader(head, place);
  Record record;
  record.fields = parse_fields(reader.block(), place);
  record.data_bytes = reader.number<std::uint32_t>();
  record.data_offset = offset + head_bytes;
  return record;
}

/// Collects the index of a file in one pass over its records.
class Ros1Indexer {
 public:
  explicit Ros1Indexer(const ChunkReader& reader) : reader_(reader), place_(reader.file().path().string()) {}

  [[nodiscard]] BagIndex run() {
    const std::uint64_t size = reader_.file().size();
    std::uint64_t position = kVersion2.size();
    while (position < size) {
      if (const std::optional<Record> record = record_of_file(position)) {
        add(*record);
        position = record->end();
        continue;
      }
      // `rosbag reindex` leaves a damaged chunk in front of the index; recorders leave zeros at the end.
      const std::uint64_t end = position < index_position_ ? std::min(index_position_, size) : size;
      if (is_foreign_) {
        index_.warnings.push_back(std::to_string(end - position) + " bytes from byte " +
                                  std::to_string(position) + " on are no records of a bag; they are ignored");
      }
      truncated_ |= !is_foreign_ && end == size;
      position = end;
    }
    // It may end between two records. Only the index of a bag without messages is empty.
    truncated_ |= index_position_ > size || (index_position_ == size && !index_.chunks.empty());
    finish();
    return std::move(index_);
  }

 private:
  /// The record at a position of the file; nullopt if the file ends within it, or (`is_foreign_`) if the
  /// bytes are not those of a record.
  std::optional<Record> record_of_file(std::uint64_t position) {
    const ByteFile& file = reader_.file();
    is_foreign_ = false;
    try {
      std::optional<Record> record = record_at(
          position, [&file](auto offset, auto count) { return file.read(offset, count); }, place_);
      is_foreign_ = record ? !record->fields.contains("op")
                           : file.read(position, kHeadBytes).find_first_not_of('\0') == std::string::npos;
      if (record && !is_foreign_ && record->end() <= file.size()) return record;
    } catch (const InputError&) {
      is_foreign_ = true;
    }
    return std::nullopt;
  }

  void add(const Record& record) {
    switch (record.number<std::uint8_t>("op", place_)) {
      case kBagHeader:
        if (record.fields.contains("encryptor") && !record.fields.at("encryptor").empty())
          throw InputError(place_, "is encrypted; decrypt it with `rosbag decrypt`");
        if (record.fields.contains("index_pos"))
          index_position_ = record.number<std::uint64_t>("index_pos", place_);
        break;
      case kChunk:
        finish_chunk();
        add_chunk(record);
        break;
      case kIndexData:
        add_index_data(record);
        break;
      case kConnection:
        add_connection(record, reader_.file().read(record.data_offset, record.data_bytes));
        break;
      default:
        break;  // chunk info is not needed, unknown records are skipped
    }
  }

  void add_chunk(const Record& record) {
    const std::string name = record.text("compression", place_);
    const std::optional<ChunkCompression> compression = compression_of(name);
    if (!compression || compression == ChunkCompression::kZstd)
      throw InputError(place_, "a chunk has the unknown compression \"" + name +
                                   "\"; convert it with `rosbag compress --lz4`");
    index_.chunks.push_back({.position = record.data_offset,
                             .stored_bytes = record.data_bytes,
                             .bytes = record.number<std::uint32_t>("size", place_),
                             .compression = *compression});
    const BagChunk& chunk = index_.chunks.back();
    if (chunk.compression == ChunkCompression::kNone && chunk.bytes != chunk.stored_bytes)
      throw InputError(place_, "a chunk has contradicting sizes; it is damaged, copy the file again");
    indexed_ = false;
    first_of_chunk_ = index_.messages.size();
  }

  void add_index_data(const Record& record) {
    if (index_.chunks.empty() || record.number<std::uint32_t>("ver", place_) != 1) return;
    const std::string data = reader_.file().read(record.data_offset, record.data_bytes);
    ByteReader entries(data, place_);
    const std::uint32_t connection = connection_index(record.number<std::uint32_t>("conn", place_));
    for (std::uint64_t i = 0; i < data.size() / kIndexEntryBytes; ++i) {
      const Timestamp t = read_ros1_time(entries);
      add_message(connection, t, entries.number<std::uint32_t>());
    }
    indexed_ = true;
  }

  void add_message(std::uint32_t connection, Timestamp t, std::uint64_t offset) {
    index_.messages.push_back({.t = t,
                               .connection = connection,
                               .chunk = static_cast<std::uint32_t>(index_.chunks.size() - 1),
                               .offset = offset});
  }

  /// The index of the connection with this number; its description may follow later.
  std::uint32_t connection_index(std::uint32_t id) {
    const auto [entry, is_new] = ids_.emplace(id, static_cast<std::uint32_t>(index_.connections.size()));
    if (is_new) index_.connections.emplace_back();
    return entry->second;
  }

  void add_connection(const Record& record, const std::string& data) {
    BagConnection& connection =
        index_.connections[connection_index(record.number<std::uint32_t>("conn", place_))];
    if (!connection.topic.empty()) return;  // written in its first chunk and at the end
    const auto fields = parse_fields(data, place_);
    const auto value = [&fields](std::string_view name) {
      const auto found = fields.find(name);
      return found == fields.end() ? std::string() : found->second;
    };
    connection = {.topic = record.text("topic", place_),
                  .type = value("type"),
                  .definition = value("message_definition"),
                  .format = WireFormat::kRos1};
  }

  /// Reads the records in the chunk that was added last, unless index records have described it.
  void finish_chunk() {
    if (index_.chunks.empty() || (indexed_ && !truncated_)) return;
    index_.messages.resize(first_of_chunk_);  // of an incomplete index
    walk_chunk(index_.chunks.size() - 1, true);
  }

  /// @param with_messages false: connections only
  void walk_chunk(std::size_t chunk, bool with_messages) {
    const std::string place = place_ + ", chunk " + std::to_string(chunk);
    const std::shared_ptr<const std::string> bytes = reader_.chunk_bytes(index_.chunks[chunk]);
    const auto read = [&bytes](std::uint64_t offset, std::uint64_t count) {
      return offset < bytes->size() ? bytes->substr(offset, count) : std::string();
    };
    for (std::uint64_t offset = 0; offset < bytes->size();) {
      const std::optional<Record> record = record_at(offset, read, place);
      if (!record || record->end() > bytes->size())
        throw InputError(place, "ends within a record; it is damaged, copy the file again");
      const std::uint8_t op = record->number<std::uint8_t>("op", place);
      if (op == kConnection) add_connection(*record, read(record->data_offset, record->data_bytes));
      if (op == kMessage && with_messages) {
        const std::string time = record->text("time", place);
        ByteReader reader(time, place);
        add_message(connection_index(record->number<std::uint32_t>("conn", place)), read_ros1_time(reader),
                    offset);
      }
      offset = record->end();
    }
  }

  /// Runs `action`, which reads a chunk. The last one of a bag that was not closed may be damaged.
  template <class Action>
  void read_chunk(const Action& action) {
    try {
      action();
    } catch (const InputError& error) {
      if (!truncated_ && index_position_ != 0) throw;
      const std::string text = "a chunk is damaged and was read in part (" + std::string(error.what()) + ")";
      if (std::ranges::find(index_.warnings, text) == index_.warnings.end()) index_.warnings.push_back(text);
    }
  }

  void finish() {
    read_chunk([this] { finish_chunk(); });
    find_missing_connections();
    if (index_.messages.empty() && (truncated_ || index_position_ == 0))
      throw InputError(place_, "ends before its first message; copy or record it again");
    if (truncated_) {
      index_.complete = false;
      index_.warnings.push_back("is not complete: it ends early, after " +
                                std::to_string(index_.chunks.size()) + " chunks; those are read");
    } else if (index_position_ == 0) {
      index_.warnings.push_back("was not closed by its recorder; all " +
                                std::to_string(index_.chunks.size()) +
                                " chunks are complete, but the end of the recording may be missing");
    }
  }

  /// A bag that was not closed has its connections in the chunks only.
  void find_missing_connections() {
    std::set<std::uint32_t> chunks;
    for (const BagMessage& message : index_.messages) {
      if (index_.connections[message.connection].topic.empty()) chunks.insert(message.chunk);
    }
    for (const std::uint32_t chunk : chunks) read_chunk([&] { walk_chunk(chunk, false); });
    const std::size_t dropped = std::erase_if(index_.messages, [this](const BagMessage& message) {
      return index_.connections[message.connection].topic.empty();
    });
    if (dropped > 0)
      index_.warnings.push_back(std::to_string(dropped) + " messages of unknown connections are skipped");
  }

  const ChunkReader& reader_;
  std::string place_;
  BagIndex index_;
  std::map<std::uint32_t, std::uint32_t> ids_;  ///< number in the file to index
  std::size_t first_of_chunk_ = 0;              ///< index of the first message of the last chunk
  bool indexed_ = true;                         ///< whether index records followed the last chunk
  bool truncated_ = false;
  bool is_foreign_ = false;           ///< whether the last position that was read has no record
  std::uint64_t index_position_ = 0;  ///< of the connections at the end; 0 = the bag was not closed
};

void require_version(const ByteFile& file) {
  const std::string line = file.read(0, kVersion2.size());
  if (line == kVersion2) return;
  const std::string place = file.path().string();
  if (line.starts_with("#ROSBAG") || line.starts_with("#ROSRECORD") || line.starts_with("#ROSLOG"))
    throw InputError(place, "is a bag of an older format than 2.0; convert it with `rosbag fix`");
  throw InputError(place, "is not a ROS 1 bag: it does not begin with \"#ROSBAG V2.0\"; copy the file again");
}

}  // namespace

Ros1Bag::Ros1Bag(const std::filesystem::path& file) : reader_(file) {
  require_version(reader_.file());
  index_ = Ros1Indexer(reader_).run();
}

std::string Ros1Bag::payload(const BagMessage& message, std::uint64_t max_bytes) const {
  const BagChunk& chunk = index_.chunks[message.chunk];
  const std::string place = reader_.file().path().string();
  const std::optional<Record> record = record_at(
      message.offset,
      [&](auto offset, auto count) {
        return reader_.read(chunk, offset, std::min<std::uint64_t>(count, 256));
      },
      place);
  if (!record || record->end() > chunk.bytes || record->number<std::uint8_t>("op", place) != kMessage)
    throw InputError(place,
                     "its index points to no message; it is damaged, restore it with `rosbag reindex`");
  return reader_.read(chunk, record->data_offset, std::min(max_bytes, record->data_bytes));
}

namespace {

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
  file_.append(kVersion2);
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
  file_.overwrite(kVersion2.size(), bag_header(index_position));
  file_.finish();
}

}  // namespace stillpoint::datasets
