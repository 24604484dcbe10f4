// SPDX-License-Identifier: BSD-3-Clause
/// Reads SQLite databases of rosbag2 (extension .db3), and writes folders of rosbag2 with one of them.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bags/bag_chunks.h"

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

/// NAME/NAME_0.db3 and NAME/metadata.yaml. The folder gets its name when it is complete.
class Rosbag2Writer {
 public:
  explicit Rosbag2Writer(std::filesystem::path folder);
  ~Rosbag2Writer();
  Rosbag2Writer(const Rosbag2Writer&) = delete;
  Rosbag2Writer& operator=(const Rosbag2Writer&) = delete;

  [[nodiscard]] std::uint32_t add_connection(std::string_view topic, std::string_view type);
  void write(std::uint32_t connection, Timestamp t, std::string_view bytes);
  void finish();

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  struct Topic {
    std::string name;
    std::string type;  ///< in the spelling of ROS 2
    std::uint64_t messages = 0;
  };

  void execute(const std::string& sql) const;
  [[noreturn]] void fail() const;
  [[nodiscard]] std::string metadata_text() const;
  [[nodiscard]] std::filesystem::path unfinished() const { return folder_.string() + ".part"; }

  std::filesystem::path folder_;
  std::string database_name_;
  std::unique_ptr<sqlite3, Close> database_;
  std::unique_ptr<sqlite3_stmt, Close> insert_;
  std::vector<Topic> topics_;
  Timestamp first_, last_;
  bool finished_ = false;
};

}  // namespace stillpoint::datasets
