// SPDX-License-Identifier: BSD-3-Clause
/// Thin wrapper of SQLite: connection, statements, transactions, and errors with a remedy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace stillpoint::bench {

enum class DatabaseAccess { kRead, kWrite };

/// A prepared statement with bound parameters, stepped row by row. Must not outlive its database.
class Statement {
 public:
  Statement(const std::filesystem::path& file, sqlite3* connection, std::string_view sql);

  /// Binds the next parameter, from left to right.
  Statement& bind(std::string_view text);
  Statement& bind(std::int64_t number);
  Statement& bind(double number);

  /// Goes to the next row. @return false after the last one
  bool step();

  [[nodiscard]] std::string text(int column) const;  ///< empty for null
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;

 private:
  void check_bound(int result);

  std::filesystem::path file_;
  sqlite3* connection_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_;
  int bound_ = 0;
};

/// A connection to one file. Waits up to a minute for the locks of other connections.
class Database {
 public:
  /// With `kWrite` a missing file is created; with `kRead` it must exist, and its folder may be read-only.
  /// @throws InputError if the file cannot be opened or is not an SQLite database
  Database(const std::filesystem::path& file, DatabaseAccess access);

  [[nodiscard]] Statement prepare(std::string_view sql) const;
  /// Executes statements without results.
  void execute(const std::string& sql) const;
  /// Executes a statement that needs the only connection, e.g. a change to a write-ahead log. SQLite does not
  /// wait for that when two connections try it at once, so it is repeated for up to a minute.
  void execute_when_free(const std::string& sql) const;
  /// First column of the first row.
  [[nodiscard]] std::int64_t integer(std::string_view sql) const;

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> connection_;
};

/// Write transaction (BEGIN IMMEDIATE); rolled back on destruction unless committed.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

}  // namespace stillpoint::bench
