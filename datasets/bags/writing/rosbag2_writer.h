// SPDX-License-Identifier: BSD-3-Clause
/// Writes folders of rosbag2 with one SQLite database.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bags/bag_index.h"

namespace stillpoint::datasets {

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
