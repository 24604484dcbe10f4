// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/rosbag2.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

std::string text_at(sqlite3_stmt* statement, int column) {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr
             ? std::string()
             : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
}

}  // namespace

Rosbag2Database::Rosbag2Database(fs::path file) : file_(std::move(file)) {
  require_regular_file(file_);
  sqlite3* opened = nullptr;
  const int result = sqlite3_open_v2(file_.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
  database_.reset(opened);
  if (result != SQLITE_OK) fail();
  if (!has_table("topics") || !has_table("messages"))
    throw InputError(
        file_.string(),
        "is not a database of rosbag2: it has no tables topics and messages; copy the file again");
  read_topics();
  if (has_table("message_definitions")) read_definitions();
  read_messages();
  select_data_ = prepare("SELECT data FROM messages WHERE id = ?");
}

void Rosbag2Database::fail() const {
  throw InputError(file_.string(), std::string("cannot be read as a database of rosbag2 (") +
                                       sqlite3_errmsg(database_.get()) + "); copy the file again");
}

Rosbag2Database::Statement Rosbag2Database::prepare(const std::string& sql) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) fail();
  return Statement(statement);
}

/// Whether there is another row.
bool Rosbag2Database::step(sqlite3_stmt* statement) const {
  const int result = sqlite3_step(statement);
  if (result != SQLITE_ROW && result != SQLITE_DONE) fail();
  return result == SQLITE_ROW;
}

bool Rosbag2Database::has_table(const std::string& name) const {
  const Statement statement =
      prepare("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = '" + name + "'");
  return step(statement.get());
}

void Rosbag2Database::read_topics() {
  const Statement statement = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  while (step(statement.get())) {
    if (text_at(statement.get(), 3) != "cdr") continue;
    topic_ids_.push_back(sqlite3_column_int64(statement.get(), 0));
    index_.connections.push_back({.topic = text_at(statement.get(), 1),
                                  .type = text_at(statement.get(), 2),
                                  .definition = {},
                                  .format = WireFormat::kCdr});
  }
}

void Rosbag2Database::read_definitions() {
  const Statement statement = prepare(
      "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = 'ros2msg'");
  while (step(statement.get())) {
    for (BagConnection& connection : index_.connections) {
      if (connection.type == text_at(statement.get(), 0)) connection.definition = text_at(statement.get(), 1);
    }
  }
}

void Rosbag2Database::read_messages() {
  std::map<std::int64_t, std::uint32_t> connection_of;
  for (std::size_t i = 0; i < topic_ids_.size(); ++i)
    connection_of.emplace(topic_ids_[i], static_cast<std::uint32_t>(i));
  const Statement statement = prepare("SELECT id, topic_id, timestamp FROM messages ORDER BY id");
  while (step(statement.get())) {
    const auto connection = connection_of.find(sqlite3_column_int64(statement.get(), 1));
    if (connection == connection_of.end()) continue;
    index_.messages.push_back(
        {.t = {sqlite3_column_int64(statement.get(), 2)},
         .connection = connection->second,
         .chunk = 0,
         .offset = static_cast<std::uint64_t>(sqlite3_column_int64(statement.get(), 0))});
  }
}

std::string Rosbag2Database::payload(const BagMessage& message) const {
  const std::scoped_lock lock(mutex_);
  sqlite3_stmt* const statement = select_data_.get();
  sqlite3_reset(statement);
  sqlite3_bind_int64(statement, 1, static_cast<sqlite3_int64>(message.offset));
  if (!step(statement)) throw InputError(file_.string(), "was changed while it was read");
  const auto* const data = static_cast<const char*>(sqlite3_column_blob(statement, 0));
  const int bytes = sqlite3_column_bytes(statement, 0);
  return data == nullptr ? std::string() : std::string(data, static_cast<std::size_t>(bytes));
}

namespace {

std::string sql_literal(std::string_view text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

}  // namespace

Rosbag2Writer::Rosbag2Writer(fs::path folder)
    : folder_(std::move(folder)), database_name_(folder_.filename().string() + "_0.db3") {
  std::error_code problem;
  fs::remove_all(unfinished(), problem);
  fs::create_directories(unfinished(), problem);
  if (problem) throw InputError(folder_.string(), "cannot be created; check that its folder is writable");
  sqlite3* opened = nullptr;
  const int result = sqlite3_open((unfinished() / database_name_).c_str(), &opened);
  database_.reset(opened);
  if (result != SQLITE_OK) fail();
  execute(
      "PRAGMA synchronous = OFF;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN;");
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                         -1, &statement, nullptr) != SQLITE_OK)
    fail();
  insert_.reset(statement);
}

Rosbag2Writer::~Rosbag2Writer() {
  if (finished_) return;
  insert_.reset();
  database_.reset();
  std::error_code ignored;
  fs::remove_all(unfinished(), ignored);
}

void Rosbag2Writer::fail() const {
  throw InputError(folder_.string(), std::string("cannot be written (") + sqlite3_errmsg(database_.get()) +
                                         "); check free disk space");
}

void Rosbag2Writer::execute(const std::string& sql) const {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::uint32_t Rosbag2Writer::add_connection(std::string_view topic, std::string_view type) {
  const std::size_t slash = type.find('/');
  const std::string ros2_type = std::string(type.substr(0, slash)) + "/msg" + std::string(type.substr(slash));
  topics_.push_back({.name = std::string(topic), .type = ros2_type});
  execute("INSERT INTO topics VALUES (" + std::to_string(topics_.size()) + ", " + sql_literal(topic) + ", " +
          sql_literal(ros2_type) + ", 'cdr', '')");
  return static_cast<std::uint32_t>(topics_.size() - 1);
}

void Rosbag2Writer::write(std::uint32_t connection, Timestamp t, std::string_view bytes) {
  sqlite3_stmt* const statement = insert_.get();
  sqlite3_reset(statement);
  sqlite3_bind_int64(statement, 1, std::int64_t{connection} + 1);
  sqlite3_bind_int64(statement, 2, t.ns);
  sqlite3_bind_blob64(statement, 3, bytes.data(), bytes.size(), SQLITE_STATIC);
  if (sqlite3_step(statement) != SQLITE_DONE) fail();
  const bool is_first = std::ranges::all_of(topics_, [](const Topic& topic) { return topic.messages == 0; });
  first_ = is_first ? t : std::min(first_, t);
  last_ = is_first ? t : std::max(last_, t);
  ++topics_[connection].messages;
}

std::string Rosbag2Writer::metadata_text() const {
  std::uint64_t messages = 0;
  std::string topics;
  for (const Topic& topic : topics_) {
    messages += topic.messages;
    topics += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n"
        "        offered_qos_profiles: \"\"\n      message_count: {}\n",
        topic.name, topic.type, topic.messages);
  }
  return fmt::format(
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  duration:\n"
      "    nanoseconds: {0}\n  starting_time:\n    nanoseconds_since_epoch: {1}\n  message_count: {2}\n"
      "  topics_with_message_count:\n{3}  compression_format: \"\"\n  compression_mode: \"\"\n"
      "  relative_file_paths:\n    - {4}\n  files:\n    - path: {4}\n      starting_time:\n"
      "        nanoseconds_since_epoch: {1}\n      duration:\n        nanoseconds: {0}\n      message_count: "
      "{2}\n",
      last_.ns - first_.ns, first_.ns, messages, topics, database_name_);
}

void Rosbag2Writer::finish() {
  execute("COMMIT");
  insert_.reset();
  database_.reset();
  std::ofstream out(unfinished() / "metadata.yaml");
  out << metadata_text();
  out.close();
  std::error_code problem;
  if (out) fs::rename(unfinished(), folder_, problem);
  if (!out || problem)
    throw InputError(
        folder_.string(),
        "cannot be written completely; check free disk space, and that the folder does not exist");
  finished_ = true;
}

}  // namespace stillpoint::datasets
