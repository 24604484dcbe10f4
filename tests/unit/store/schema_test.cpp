// SPDX-License-Identifier: BSD-3-Clause
// Stores of older schema versions are read as they are, and migrated when they are written.
#include "bench/store/schema.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "bench/store/maintenance/maintenance.h"
#include "bench/store/maintenance/store_export.h"
#include "bench/store/store_writer.h"
#include "core/base/content_hash.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

const RunIdentity kIdentity{.variant = "vo", .sequence = "office"};

std::int64_t version_of(const fs::path& file) {
  return Database(file, DatabaseAccess::kRead).integer("PRAGMA user_version");
}

/// A store with one run in the tables of an older schema version, written with the column names of that time.
fs::path old_store(const TemporaryFolder& folder, int version) {
  fs::path file = folder.path() / "old.sqlite";
  const Database database(file, DatabaseAccess::kWrite);
  migrate(database, version);
  database
      .prepare(
          "INSERT INTO run (id, key, system, variant, sequence, sequence_id, config_hash, build, mode, kind, "
          "cores, seed, repetition, axis, axis_value, state, driver, started, ended, outcome, detail) "
          "VALUES (1, ?, 'stillpoint', 'vo', 'office', '', '', '', 'sequential', 'accuracy', '', 1, 1, '', "
          "0.0, 'ended', '17-1', '', '', 'ok', '')")
      .bind(run_key(kIdentity))
      .step();
  database.execute(
      "INSERT INTO metric (run, name, recipe, unit, value) VALUES (1, 'ate_rmse_m', 'tum', 'm', 0.5)");
  const BlobFiles blobs(files_folder(file) / "blobs");
  for (const char* kind : {"picture:000042", "log"}) {
    database.prepare("INSERT INTO attachment (run, kind, blob) VALUES (1, ?, ?)")
        .bind(kind)
        .bind(blobs.put(kind))
        .step();
  }
  return file;
}

void expect_the_run(const Store& store) {
  const std::vector<StoredRun> runs = store.runs();
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_EQ(runs.front().metrics.size(), 1u);
  EXPECT_EQ(runs.front().metrics.front().name, "ate_rmse_m");
  EXPECT_EQ(runs.front().metrics.front().protocol, "tum");
  EXPECT_EQ(runs.front().metrics.front().value, 0.5);
  EXPECT_EQ(runs.front().blobs.size(), 2u);
  EXPECT_EQ(store.attachment(runs.front(), "image:000042"), "picture:000042");
  EXPECT_EQ(store.attachment(runs.front(), "log"), "log");
}

// A change of this hash means that existing stores would differ from new ones: add a migration step instead.
TEST(Schema, PublishedStepsAreUnchanged) {
  const TemporaryFolder folder;
  const Database database(folder.path() / "old.sqlite", DatabaseAccess::kWrite);
  migrate(database, 2);
  std::string sql;
  Statement rows = database.prepare("SELECT sql FROM sqlite_master WHERE sql NOT NULL ORDER BY name");
  while (rows.step()) sql += rows.text(0) + ";\n";
  EXPECT_EQ(hash_text(content_hash(sql)), "ab5d730a3f811221");
}

TEST(Schema, OlderStoresAreReadWithoutMigration) {
  for (const int version : {1, 2}) {
    const TemporaryFolder folder;
    const fs::path file = old_store(folder, version);
    const Store store(file);
    expect_the_run(store);
    EXPECT_TRUE(store.acceptances().empty());
    EXPECT_TRUE(verify_store(file).empty());
    EXPECT_EQ(version_of(file), version);
  }
}

TEST(Schema, OlderStoresAreMigratedForWriting) {
  for (const int version : {1, 2}) {
    const TemporaryFolder folder;
    const fs::path file = old_store(folder, version);
    StoreWriter writer(file);
    EXPECT_EQ(version_of(file), schema_version());
    EXPECT_EQ(writer.acquire(kIdentity), RunLease::kDone);
    expect_the_run(Store(file));
    EXPECT_EQ(writer.acquire({.variant = "other"}), RunLease::kGranted);
    writer.finish({.variant = "other"}, {.metrics = {{"ate_rmse_m", "tum", "m", 0.25}}});
    EXPECT_EQ(Store(file).runs().size(), 2u);
  }
}

TEST(Schema, AcceptancesMigrateAStoreOfVersion1) {
  const TemporaryFolder folder;
  const fs::path file = old_store(folder, 1);
  write_acceptances(file, {{.commit = "abc", .metric = "ate_rmse_m"}});
  EXPECT_EQ(version_of(file), schema_version());
  EXPECT_EQ(Store(file).acceptances().size(), 1u);
  expect_the_run(Store(file));
}

TEST(Schema, AnOpenReaderSurvivesAMigration) {
  const TemporaryFolder folder;
  const fs::path file = old_store(folder, 2);
  const Store store(file);
  expect_the_run(store);
  const StoreWriter writer(file);
  expect_the_run(store);
}

TEST(Schema, OlderStoresAreMerged) {
  const TemporaryFolder folder;
  const fs::path into = folder.path() / "new.sqlite";
  EXPECT_EQ(merge_stores(old_store(folder, 2), into).added, 1u);
  expect_the_run(Store(into));
}

TEST(Schema, ExportsOfVersion1AreImported) {
  const TemporaryFolder folder;
  std::string text = export_store(old_store(folder, 2));
  const auto replace = [&](const std::string& current, const std::string& old) {
    const std::size_t at = text.find(current);
    ASSERT_NE(at, std::string::npos) << current;
    text.replace(at, current.size(), old);
  };
  replace("\"stillpoint_store\": 4", "\"stillpoint_store\": 1");
  replace("\"protocol\"", "\"recipe\"");
  replace("\"image:000042\"", "\"picture:000042\"");
  const std::vector<StoredRun> runs = exported_runs(text, "runs.json");
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs.front().metrics.front().protocol, "tum");
  const fs::path into = folder.path() / "new.sqlite";
  EXPECT_EQ(import_store(text, "runs.json", into).added, 1u);
  expect_the_run(Store(into));
}

TEST(Schema, TheCommittedBaselineIsReadable) {
  const fs::path file = fs::path(STILLPOINT_SOURCE_DIR) / "bench/baselines/quick_instructions.json";
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::vector<StoredRun> runs = exported_runs(text, file.string());
  ASSERT_FALSE(runs.empty());
  for (const StoredRun& run : runs) EXPECT_TRUE(metric_value(run, "instructions")) << run.key;
}

}  // namespace
}  // namespace stillpoint::bench
