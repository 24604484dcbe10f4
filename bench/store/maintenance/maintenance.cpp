// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/maintenance.h"

#include <algorithm>
#include <set>

#include "bench/store/maintenance/run_transfer.h"
#include "bench/store/schema.h"
#include "bench/store/store.h"
#include "bench/store/store_writer.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// Runs a check of the database. @return one text per fault
std::vector<std::string> faults_of(Statement check, const std::string& what) {
  std::vector<std::string> faults;
  while (check.step()) {
    if (check.text(0) != "ok") faults.push_back(what + ": " + check.text(0));
  }
  return faults;
}

/// One text per metric without a finite value; 9e999 is the infinity of SQL.
std::vector<std::string> infinite_metrics(const Database& database) {
  std::vector<std::string> faults;
  Statement rows = database.prepare(
      "SELECT run.key, name FROM metric JOIN run ON run.id = metric.run WHERE abs(value) = 9e999");
  while (rows.step())
    faults.push_back("run " + rows.text(0) + ": metric \"" + rows.text(1) + "\" is infinite");
  return faults;
}

std::set<std::string> referenced_files(const Database& database) {
  std::set<std::string> names;
  Statement rows = database.prepare("SELECT DISTINCT blob FROM attachment");
  while (rows.step()) names.insert(rows.text(0));
  return names;
}

/// One text per referenced file that cannot be read.
std::vector<std::string> damaged_files(const Database& database, const BlobFiles& blobs) {
  std::vector<std::string> faults;
  for (const std::string& name : referenced_files(database)) {
    try {
      static_cast<void>(blobs.get(name));
    } catch (const InputError& error) {
      faults.emplace_back(error.what());
    }
  }
  return faults;
}

RunOutcome outcome_from(const Store& store, const StoredRun& run) {
  RunOutcome outcome{.outcome = run.outcome,
                     .detail = run.detail,
                     .metrics = run.metrics,
                     .costs = run.costs,
                     .attachments = {},
                     .manifest = store.manifest(run)};
  for (const auto& [kind, blob] : run.blobs) outcome.attachments[kind] = store.attachment(run, kind);
  return outcome;
}

}  // namespace

std::vector<std::string> verify_store(const fs::path& file) {
  const Database database(file, DatabaseAccess::kRead);
  require_readable_schema(database);
  std::vector<std::string> faults;
  // A damaged page can end each check; the others are still executed.
  const auto add = [&](const auto& check) {
    try {
      for (std::string& fault : check()) faults.push_back(std::move(fault));
    } catch (const InputError& error) {
      faults.emplace_back(error.what());
    }
  };
  add([&] { return faults_of(database.prepare("PRAGMA integrity_check"), "database"); });
  add([&] {
    return faults_of(database.prepare("PRAGMA foreign_key_check"), "row with a missing reference");
  });
  add([&] { return infinite_metrics(database); });
  add([&] { return damaged_files(database, BlobFiles(files_folder(file) / "blobs")); });
  return faults;
}

GarbageReport collect_garbage(const fs::path& file) {
  static_cast<void>(Store(file));   // a writer would create a store, also in an empty file
  const StoreWriter cleared(file);  // removes the folders of dead workers
  const Database database(file, DatabaseAccess::kWrite);
  const BlobFiles blobs(files_folder(file) / "blobs");
  Transaction transaction(database);  // blocks writers, which could reference an unused file
  GarbageReport report;
  const std::set<std::string> referenced = referenced_files(database);
  for (const std::string& name : blobs.names()) {
    if (referenced.contains(name)) continue;
    ++report.files;
    report.bytes += static_cast<std::int64_t>(fs::file_size(blobs.file(name)));
    blobs.remove(name);
  }
  constexpr const char* kUnused =
      "FROM manifest WHERE hash NOT IN (SELECT manifest FROM run WHERE manifest NOT NULL)";
  report.manifests = static_cast<std::size_t>(database.integer(std::string("SELECT count(*) ") + kUnused));
  database.execute(std::string("DELETE ") + kUnused);
  transaction.commit();
  return report;
}

MergeReport merge_stores(const fs::path& from, const fs::path& into) {
  if (fs::exists(into) && fs::equivalent(from, into)) throw InputError(into.string(), "is the same store");
  const Store source(from);
  StoreWriter writer(into);
  MergeReport report;
  for (const StoredRun& run : source.runs()) {
    const bool is_added = add_run(writer, run.identity, outcome_from(source, run));
    ++(is_added ? report.added : report.present);
  }
  for (const StoredPlan& plan : source.plans()) writer.record_plan(plan);
  write_acceptances(into, source.acceptances());
  return report;
}

}  // namespace stillpoint::bench
