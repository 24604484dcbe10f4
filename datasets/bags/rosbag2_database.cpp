// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/rosbag2_database.h"

#include <map>
#include <utility>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

std::string text_at(sqlite3_stmt* statement, int column) {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr
             ? std::string()
             : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
}

}  // namespace

Rosbag2Database::Rosbag2Database(std::filesystem::path file) : file_(std::move(file)) {
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

}  // namespace stillpoint::datasets
