// SPDX-License-Identifier: BSD-3-Clause
/// SQLite databases of rosbag2 (extension .db3).
#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "datasets/bags/bag_index.h"

namespace stillpoint::datasets {

/// Tables `topics` (id, name, type, serialization_format) and `messages` (id, topic_id, timestamp, data), and
/// `message_definitions` in databases of later versions. Topics of other formats than CDR are ignored.
class Rosbag2Database {
 public:
  /// @throws InputError if the file is no such database, or is damaged
  explicit Rosbag2Database(std::filesystem::path file);

  [[nodiscard]] const BagIndex& index() const { return index_; }

  /// The serialized message. Thread-safe.
  /// @throws InputError if the file is damaged
  [[nodiscard]] std::string payload(const BagMessage& message) const;

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  [[nodiscard]] Statement prepare(const std::string& sql) const;
  [[nodiscard]] bool step(sqlite3_stmt* statement) const;
  [[nodiscard]] bool has_table(const std::string& name) const;
  [[noreturn]] void fail() const;
  void read_topics();
  void read_definitions();
  void read_messages();

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> database_;
  BagIndex index_;
  std::vector<std::int64_t> topic_ids_;  ///< of the connections
  mutable std::mutex mutex_;             ///< guards the statement
  Statement select_data_;
};

}  // namespace stillpoint::datasets
