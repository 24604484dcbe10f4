// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/database.h"

#include <sqlite3.h>

#include "core/base/error.h"
#include "core/base/system_resources.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kBusyTimeoutMs = 60'000;

/// Advice for the user about a failure.
std::string remedy(int result) {
  switch (result & 0xff) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
      return "free space on the disk and retry; everything stored so far is preserved";
    case SQLITE_READONLY:
      return "it is read-only; give another file with --store, or make it writable";
    case SQLITE_CORRUPT:
      return "it is damaged; save what is readable with `stillpoint store salvage STORE OUT`";
    case SQLITE_NOTADB:
      return "give the file of a store, or the name of a new one; if it was a store, save what is readable "
             "with `stillpoint store salvage STORE OUT`";
    case SQLITE_BUSY:
      return "another process has been writing for a minute; retry later";
    default:
      return "check that its folder exists and its permissions";
  }
}

[[noreturn]] void fail(const fs::path& file, sqlite3* connection, int result) {
  if (connection != nullptr) require_resources(sqlite3_system_errno(connection), file.string());
  const std::string what = connection != nullptr ? sqlite3_errmsg(connection) : sqlite3_errstr(result);
  throw InputError(file.string(), what + "; " + remedy(result));
}

int open_connection(const std::string& name, int flags, sqlite3** connection) {
  const int result = sqlite3_open_v2(name.c_str(), connection, flags, nullptr);
  sqlite3_busy_timeout(*connection, kBusyTimeoutMs);  // before the first statement: its lock can be taken
  return result;
}

/// In a read-only folder SQLite cannot create the shared memory of its write-ahead log; the file is then
/// opened as immutable.
int open_read_only(const fs::path& file, sqlite3** connection) {
  int result = open_connection(file.string(), SQLITE_OPEN_READONLY, connection);
  if (result == SQLITE_OK)
    result = sqlite3_exec(*connection, "SELECT 1 FROM sqlite_master", nullptr, nullptr, nullptr);
  const int kind = result & 0xff;
  if (kind != SQLITE_CANTOPEN && kind != SQLITE_READONLY) return result;
  require_resources(sqlite3_system_errno(*connection), file.string());  // else its log would be ignored
  sqlite3_close(*connection);
  const std::string uri = "file:" + fs::absolute(file).string() + "?immutable=1";
  return open_connection(uri, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, connection);
}

sqlite3* open_file(const fs::path& file, DatabaseAccess access) {
  if (access == DatabaseAccess::kRead && !fs::is_regular_file(file)) {
    throw InputError(file.string(),
                     "there is no such store; create one with `stillpoint bench PLAN --store FILE`");
  }
  require_regular_file(file);  // SQLite would create its log beside a device
  sqlite3* connection = nullptr;
  const int result =
      access == DatabaseAccess::kRead
          ? open_read_only(file, &connection)
          : open_connection(file.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, &connection);
  if (result == SQLITE_OK) return connection;
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> closer(connection, sqlite3_close);
  fail(file, connection, result);
}

}  // namespace

Statement::Statement(const fs::path& file, sqlite3* connection, std::string_view sql)
    : file_(file), connection_(connection), statement_(nullptr, sqlite3_finalize) {
  sqlite3_stmt* statement = nullptr;
  const int result =
      sqlite3_prepare_v2(connection, sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  statement_.reset(statement);
  if (result != SQLITE_OK) fail(file_, connection_, result);
}

void Statement::check_bound(int result) {
  if (result != SQLITE_OK) fail(file_, connection_, result);
}

Statement& Statement::bind(std::string_view text) {
  check_bound(sqlite3_bind_text(statement_.get(), ++bound_, text.data(), static_cast<int>(text.size()),
                                SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind(std::int64_t number) {
  check_bound(sqlite3_bind_int64(statement_.get(), ++bound_, number));
  return *this;
}

Statement& Statement::bind(double number) {
  check_bound(sqlite3_bind_double(statement_.get(), ++bound_, number));
  return *this;
}

bool Statement::step() {
  const int result = sqlite3_step(statement_.get());
  if (result != SQLITE_ROW && result != SQLITE_DONE) fail(file_, connection_, result);
  return result == SQLITE_ROW;
}

std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  if (text == nullptr) return "";
  const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return {reinterpret_cast<const char*>(text), bytes};
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
double Statement::real(int column) const { return sqlite3_column_double(statement_.get(), column); }

Database::Database(const fs::path& file, DatabaseAccess access)
    : file_(file), connection_(open_file(file, access), sqlite3_close) {
  sqlite3_extended_result_codes(connection_.get(), 1);
  execute("PRAGMA foreign_keys = ON");
  static_cast<void>(integer("SELECT count(*) FROM sqlite_master"));  // reads the header
}

Statement Database::prepare(std::string_view sql) const { return {file_, connection_.get(), sql}; }

void Database::execute(const std::string& sql) const {
  const int result = sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (result != SQLITE_OK) fail(file_, connection_.get(), result);
}

void Database::execute_when_free(const std::string& sql) const {
  constexpr int kWaitMs = 10;
  int result = sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  for (int ms = 0; (result & 0xff) == SQLITE_BUSY && ms < kBusyTimeoutMs; ms += kWaitMs) {
    sqlite3_sleep(kWaitMs);
    result = sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  }
  if (result != SQLITE_OK) fail(file_, connection_.get(), result);
}

std::int64_t Database::integer(std::string_view sql) const {
  Statement statement = prepare(sql);
  return statement.step() ? statement.integer(0) : 0;
}

Transaction::Transaction(const Database& database) : database_(database) {
  database_.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const InputError&) {
    // SQLite may have rolled back already, and the exception that unwinds the stack describes the error.
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace stillpoint::bench
