// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/acceptance.h"

#include "bench/store/schema.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

Database existing_store(const std::filesystem::path& file) {
  static_cast<void>(Database(file, DatabaseAccess::kRead));  // throws if there is none
  Database database(file, DatabaseAccess::kWrite);
  migrate(database);
  return database;
}

}  // namespace

std::vector<Acceptance> read_acceptances(const Database& database) {
  std::vector<Acceptance> acceptances;
  if (database.integer("SELECT count(*) FROM sqlite_master WHERE name = 'acceptance'") == 0)
    return acceptances;
  Statement rows = database.prepare(
      "SELECT build, metric, variant, sequence, reason, accepted FROM acceptance "
      "ORDER BY build, metric, variant, sequence");
  while (rows.step()) {
    acceptances.push_back(
        {rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.text(5)});
  }
  return acceptances;
}

void write_acceptances(const std::filesystem::path& file, const std::vector<Acceptance>& acceptances) {
  const Database database = existing_store(file);
  Transaction transaction(database);
  for (const Acceptance& acceptance : acceptances) {
    database
        .prepare(
            "INSERT OR REPLACE INTO acceptance (build, metric, variant, sequence, reason, accepted) "
            "VALUES (?, ?, ?, ?, ?, ?)")
        .bind(acceptance.commit)
        .bind(acceptance.metric)
        .bind(acceptance.variant)
        .bind(acceptance.sequence)
        .bind(acceptance.reason)
        .bind(acceptance.accepted)
        .step();
  }
  transaction.commit();
}

bool withdraw_acceptance(const std::filesystem::path& file, const Acceptance& acceptance) {
  const Database database = existing_store(file);
  Transaction transaction(database);
  database.prepare("DELETE FROM acceptance WHERE build = ? AND metric = ? AND variant = ? AND sequence = ?")
      .bind(acceptance.commit)
      .bind(acceptance.metric)
      .bind(acceptance.variant)
      .bind(acceptance.sequence)
      .step();
  const bool removed = database.integer("SELECT changes()") > 0;
  transaction.commit();
  return removed;
}

}  // namespace stillpoint::bench
