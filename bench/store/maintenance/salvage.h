// SPDX-License-Identifier: BSD-3-Clause
/// Recovery of the readable content of a damaged store.
///
/// Reads the rows of a database file of which some pages are damaged.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/store/database.h"
#include "core/base/error.h"

namespace stillpoint::bench {

/// A private copy of a damaged store; the store itself is only read as a file.
class DamagedDatabase {
 public:
  /// Copies the file and its write-ahead log. If the first page is damaged, which contains the list of
  /// tables, it is replaced by that of an empty store: the tables of stores have the same root pages unless
  /// the store was migrated from an older schema.
  /// @param folder for the copy; must not exist, removed by the destructor
  /// @throws InputError if the file cannot be copied, or is not a store
  DamagedDatabase(const std::filesystem::path& store, std::filesystem::path folder);
  ~DamagedDatabase();
  DamagedDatabase(const DamagedDatabase&) = delete;
  DamagedDatabase& operator=(const DamagedDatabase&) = delete;

  [[nodiscard]] const Database& database() const { return *database_; }
  [[nodiscard]] bool has_replaced_header() const { return replaced_header_; }

  /// Calls `use(row)` for each readable row of a query: in ascending order of the columns `order` up to the
  /// first damaged page, and then in descending order down to the last one.
  /// @param query without ORDER BY; an index must contain the rows in this order
  /// @return whether all rows were readable
  template <class Use>
  bool for_each_row(const std::string& query, const std::vector<std::string>& order, const Use& use) const;

 private:
  std::filesystem::path folder_;
  std::unique_ptr<Database> database_;
  bool replaced_header_ = false;
};

/// "a DESC, b DESC" of {"a", "b"} with the direction " DESC".
[[nodiscard]] std::string order_text(const std::vector<std::string>& columns, const char* direction);

template <class Use>
bool DamagedDatabase::for_each_row(const std::string& query, const std::vector<std::string>& order,
                                   const Use& use) const {
  for (const char* direction : {"", " DESC"}) {
    try {
      Statement rows = database_->prepare(query + " ORDER BY " + order_text(order, direction));
      while (rows.step()) use(rows);
      return *direction == '\0';
    } catch (const InputError&) {
      continue;  // a damaged page; the rows behind it are read from the other end
    }
  }
  return false;
}

struct SalvageReport {
  std::map<std::string, std::size_t> saved;  ///< rows by table, and "file": attached files
  std::vector<std::string> losses;           ///< one line each; empty if everything was readable
};

/// Copies what is readable of a damaged store into a new one, row by row: completed runs with their metrics,
/// times, files and manifests; plans; acceptances. `from` is not changed. Identities and files are verified
/// by their hashes; altered numbers in otherwise valid rows cannot be noticed. A saved run of which rows are
/// lost has a detail that says so.
/// @param into must not exist
/// @throws InputError if `into` exists or cannot be written, or if nothing of `from` is readable
SalvageReport salvage_store(const std::filesystem::path& from, const std::filesystem::path& into);

}  // namespace stillpoint::bench
