// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/maintenance.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "bench/store/maintenance/store_export.h"
#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

RunIdentity identity_of(const std::string& variant) { return {.variant = variant, .sequence = "office"}; }

/// A store with one run for each variant.
fs::path store_of(const TemporaryFolder& folder, const std::string& name,
                  const std::vector<std::string>& variants) {
  fs::path file = folder.path() / name;
  StoreWriter writer(file);
  for (const std::string& variant : variants) {
    static_cast<void>(writer.acquire(identity_of(variant)));
    writer.finish(identity_of(variant), {.outcome = Outcome::kOk,
                                         .metrics = {{"ate_rmse_m", "r", "m", 0.5}},
                                         .costs = {{"window_solve", "call", 3, 1.0, 1.0, 2.0, 3.0}},
                                         .attachments = {{"log", "log of " + variant}},
                                         .manifest = "{}"});
  }
  return file;
}

TEST(StoreMaintenance, AnIntactStoreHasNoFaults) {
  const TemporaryFolder folder;
  EXPECT_TRUE(verify_store(store_of(folder, "s.sqlite", {"a", "b"})).empty());
}

TEST(StoreMaintenance, VerifyListsDamagedAndMissingFiles) {
  const TemporaryFolder folder;
  const fs::path file = store_of(folder, "s.sqlite", {"a", "b", "c"});
  const BlobFiles blobs(files_folder(file) / "blobs");
  std::ofstream(blobs.file(blobs.names()[0]), std::ios::trunc) << "x";
  fs::remove(blobs.file(blobs.names()[1]));
  EXPECT_EQ(verify_store(file).size(), 2u);
}

TEST(StoreMaintenance, GarbageCollectionRemovesOnlyUnreferencedFiles) {
  const TemporaryFolder folder;
  const fs::path file = store_of(folder, "s.sqlite", {"a", "b"});
  StoreWriter(file).remove_runs({run_key(identity_of("a"))}, {Outcome::kOk});
  const GarbageReport report = collect_garbage(file);
  EXPECT_EQ(report.files, 1u);
  EXPECT_GT(report.bytes, 0);
  EXPECT_EQ(report.manifests, 0u);  // the other run has the same manifest
  EXPECT_TRUE(verify_store(file).empty());
  EXPECT_EQ(collect_garbage(file).files, 0u);
}

TEST(StoreMaintenance, MergeAddsMissingRuns) {
  const TemporaryFolder folder;
  const fs::path from = store_of(folder, "from.sqlite", {"a", "b"});
  const fs::path into = store_of(folder, "into.sqlite", {"b", "c"});
  const MergeReport report = merge_stores(from, into);
  EXPECT_EQ(report.added, 1u);
  EXPECT_EQ(report.present, 1u);
  const Store merged(into);
  ASSERT_EQ(merged.runs().size(), 3u);
  EXPECT_EQ(merged.attachment(merged.runs({.variant = "a"}).front(), "log"), "log of a");
  expect_input_error([&] { merge_stores(into, into); }, {"is the same store"});
}

TEST(StoreMaintenance, MergeOfACopyRestoresDamagedAndMissingFiles) {
  const TemporaryFolder folder;
  const fs::path file = store_of(folder, "s.sqlite", {"a", "b", "c"});
  const fs::path copy = store_of(folder, "copy.sqlite", {"a", "b", "c"});
  const BlobFiles blobs(files_folder(file) / "blobs");
  std::ofstream(blobs.file(blobs.names()[0]), std::ios::trunc) << "x";
  fs::remove(blobs.file(blobs.names()[1]));
  const MergeReport report = merge_stores(copy, file);
  EXPECT_EQ(report.added, 0u);
  EXPECT_EQ(report.restored, 2u);
  EXPECT_TRUE(verify_store(file).empty());
  EXPECT_EQ(merge_stores(copy, file).restored, 0u);
}

TEST(StoreMaintenance, MergeImportAndExportKeepTheTimesOfRuns) {
  const TemporaryFolder folder;
  const fs::path from = folder.path() / "from.sqlite";
  {
    StoreWriter writer(from);
    static_cast<void>(writer.acquire(identity_of("old")));
    writer.finish(
        identity_of("old"),
        {.manifest =
             R"({"build": {"git_time": "2019-01-01T00:00:00Z"}, "host": {"cpu": "A", "logical_cpus": 2}})",
         .started = "2020-01-01T00:00:00Z",
         .ended = "2020-01-01T00:00:09Z"});
  }
  const fs::path merged = store_of(folder, "merged.sqlite", {"new"});
  merge_stores(from, merged);
  const fs::path imported = store_of(folder, "imported.sqlite", {"new"});
  import_store(export_store(from), "runs.json", imported);
  const fs::path from_numbers = store_of(folder, "from_numbers.sqlite", {"new"});
  import_store(export_store(from, ExportExtent::kNumbers), "numbers.json", from_numbers);
  for (const fs::path& file : {from, merged, imported, from_numbers}) {
    const StoredRun run = Store(file).runs().front();  // the oldest, although it was added last
    EXPECT_EQ(run.started, "2020-01-01T00:00:00Z") << file;
    EXPECT_EQ(run.ended, "2020-01-01T00:00:09Z") << file;
    EXPECT_EQ(run.committed, "2019-01-01T00:00:00Z") << file;
    EXPECT_EQ(run.machine, "A, 2 processors") << file;
  }
  const StoredRun numbers = exported_runs(export_store(from, ExportExtent::kNumbers), "n.json").front();
  EXPECT_EQ(numbers.committed, "2019-01-01T00:00:00Z");
  EXPECT_EQ(numbers.machine, "A, 2 processors");
}

TEST(StoreMaintenance, NumbersNameTheTrajectoryByItsHash) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "from.sqlite";
  {
    StoreWriter writer(file);
    static_cast<void>(writer.acquire(identity_of("a")));
    writer.finish(identity_of("a"), {.attachments = {{"trajectory", "1 0 0 0 0 0 0 1\n"}}});
  }
  const std::string text = export_store(file, ExportExtent::kNumbers);
  const StoredRun run = exported_runs(text, "n.json").front();
  EXPECT_EQ(run.blobs.at("trajectory"), Store(file).runs().front().blobs.at("trajectory"));
  // Version 3 had no hashes.
  std::string older = text;
  older.replace(older.find("\"trajectory_hash\""), 17, "\"unknown\"");
  EXPECT_FALSE(exported_runs(older, "n.json").front().blobs.contains("trajectory"));
}

TEST(StoreMaintenance, AnInfiniteMetricIsAnErrorAndSurvivesExportAndImport) {
  const TemporaryFolder folder;
  const fs::path from = folder.path() / "from.sqlite";
  {
    StoreWriter writer(from);
    static_cast<void>(writer.acquire(identity_of("a")));
    const double infinity = std::numeric_limits<double>::infinity();
    writer.finish(identity_of("a"), {.outcome = Outcome::kOk,
                                     .metrics = {{"up", "r", "m", infinity}, {"down", "r", "m", -infinity}},
                                     .costs = {},
                                     .attachments = {},
                                     .manifest = "{}"});
  }
  const std::vector<std::string> faults = verify_store(from);
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_NE(faults.front().find("metric \"down\" is infinite"), std::string::npos) << faults.front();
  const fs::path into = folder.path() / "into.sqlite";
  EXPECT_EQ(import_store(export_store(from), "runs.json", into).added, 1u);
  const StoredRun run = Store(into).runs().front();
  EXPECT_EQ(metric_value(run, "up"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(metric_value(run, "down"), -std::numeric_limits<double>::infinity());
}

TEST(StoreMaintenance, ExportAndImportPreserveEverything) {
  const TemporaryFolder folder;
  const fs::path from = store_of(folder, "from.sqlite", {"a", "b"});
  StoreWriter(from).record_plan(
      {.name = "p", .title = "P", .text = "t", .run_keys = {run_key(identity_of("b"))}});
  const fs::path into = folder.path() / "into.sqlite";
  EXPECT_EQ(import_store(export_store(from), "runs.json", into).added, 2u);
  const Store imported(into);
  const StoredRun run = imported.plan_runs("p").front();
  EXPECT_EQ(run.identity.variant, "b");
  EXPECT_EQ(metric_value(run, "ate_rmse_m"), 0.5);
  EXPECT_EQ(run.costs.front().calls, 3);
  EXPECT_EQ(imported.attachment(run, "log"), "log of b");
  EXPECT_EQ(imported.manifest(run), "{}");
}

TEST(StoreMaintenance, RunsThatArePresentWithOtherErrorsAreNamed) {
  const TemporaryFolder folder;
  const fs::path into = store_of(folder, "into.sqlite", {"a", "b"});
  std::string text = export_store(into);
  EXPECT_TRUE(import_store(text, "runs.json", into).contradicting.empty());
  const std::size_t error = text.find("0.5");  // of the first run
  ASSERT_NE(error, std::string::npos);
  text.replace(error, 3, "0.7");
  const MergeReport imported = import_store(text, "runs.json", into);
  EXPECT_EQ(imported.present, 2u);
  ASSERT_EQ(imported.contradicting.size(), 1u);
  EXPECT_NE(imported.contradicting.front().find(run_key(identity_of("a"))), std::string::npos)
      << imported.contradicting.front();
  const fs::path other = folder.path() / "other.sqlite";
  import_store(text, "runs.json", other);
  EXPECT_EQ(merge_stores(other, into).contradicting, imported.contradicting);
}

TEST(StoreMaintenance, ExportAndImportPreserveEveryByteOfFiles) {
  const TemporaryFolder folder;
  const fs::path from = folder.path() / "from.sqlite";
  const std::string jpeg("\xFF\xD8\xFF\xE0\0\x10JFIF", 10);
  const std::string log = "caf\xE9";
  {
    StoreWriter writer(from);
    static_cast<void>(writer.acquire(identity_of("a")));
    writer.finish(identity_of("a"), {.attachments = {{"image:000042", jpeg}, {"log", log}}});
  }
  const fs::path into = folder.path() / "into.sqlite";
  import_store(export_store(from), "runs.json", into);
  const Store imported(into);
  const StoredRun run = imported.runs().front();
  EXPECT_EQ(imported.attachment(run, "image:000042"), jpeg);
  EXPECT_EQ(imported.attachment(run, "log"), log);
}

TEST(StoreMaintenance, ImagesThatOldExportsDamagedAreNotImported) {
  const TemporaryFolder folder;
  const fs::path from = folder.path() / "from.sqlite";
  {
    StoreWriter writer(from);
    static_cast<void>(writer.acquire(identity_of("a")));
    writer.finish(identity_of("a"),
                  {.attachments = {{"image:000042", "\xEF\xBF\xBD\xEF\xBF\xBD"}, {"log", "l"}}});
  }
  const fs::path into = folder.path() / "into.sqlite";
  import_store(export_store(from), "runs.json", into);
  const StoredRun run = Store(into).runs().front();
  EXPECT_EQ(run.blobs.size(), 1U);
  EXPECT_TRUE(run.blobs.contains("log"));
}

TEST(StoreMaintenance, ExportsNumbersWithoutFiles) {
  const TemporaryFolder folder;
  const fs::path from = store_of(folder, "from.sqlite", {"a", "b"});
  const std::string text = export_store(from, ExportExtent::kNumbers);
  EXPECT_EQ(text.find("log of a"), std::string::npos);
  const std::vector<StoredRun> runs = exported_runs(text, "runs.json");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[1].identity.variant, "b");
  EXPECT_EQ(metric_value(runs[1], "ate_rmse_m"), 0.5);
  expect_input_error([] { static_cast<void>(exported_runs("[]", "runs.json")); }, {"not an exported store"});
}

TEST(StoreMaintenance, RejectsATextThatIsNotAnExport) {
  const TemporaryFolder folder;
  const fs::path into = folder.path() / "into.sqlite";
  expect_input_error([&] { import_store("{", "runs.json", into); }, {"runs.json", "not an exported store"});
  expect_input_error([&] { import_store("{\"stillpoint_store\": 5}", "runs.json", into); },
                     {"newer version"});
}

}  // namespace
}  // namespace stillpoint::bench
