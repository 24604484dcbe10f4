// SPDX-License-Identifier: BSD-3-Clause
// A store with damaged pages: what is readable is saved, and what is lost is named.
#include "bench/store/maintenance/salvage.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "bench/store/maintenance/maintenance.h"
#include "bench/store/store.h"
#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kRuns = 120;
constexpr std::size_t kPageBytes = 4096;

RunIdentity identity_of(std::int64_t repetition) {
  return {.variant = "vo", .sequence = "office", .repetition = repetition};
}

/// A store of about 60 pages: runs with 20 metrics, two costs and two files each, a plan and an acceptance.
void fill_store(const fs::path& file) {
  {
    StoreWriter writer(file);
    StoredPlan plan{.name = "p", .title = "P", .text = "t", .run_keys = {}};
    for (std::int64_t i = 1; i <= kRuns; ++i) {
      const std::string number = std::to_string(i);
      RunOutcome outcome{
          .outcome = Outcome::kOk,
          .costs = {{"solve", "call", 3, 1.0, 1.0, 2.0, 3.0}, {"track", "call", 3, 1.0, 1.0, 2.0, 3.0}},
          .attachments = {{"log", "log " + number}, {"frames", "same"}},
          .manifest = "{\"run\": " + number + ", \"padding\": \"" + std::string(300, 'x') + "\"}"};
      for (int m = 0; m < 20; ++m)
        outcome.metrics.push_back(
            {"metric_" + std::to_string(m), "protocol", "m", 0.5 * static_cast<double>(i)});
      static_cast<void>(writer.acquire(identity_of(i)));
      writer.finish(identity_of(i), outcome);
      plan.run_keys.push_back(run_key(identity_of(i)));
    }
    writer.record_plan(plan);
  }
  write_acceptances(file, {{"abc", "ate_rmse_m", "", "", "reason", "2026-01-01"}});
  Database(file, DatabaseAccess::kWrite).execute("PRAGMA wal_checkpoint(TRUNCATE)");
}

/// A copy of the filled store, which is created once.
fs::path make_store(const TemporaryFolder& folder) {
  static const TemporaryFolder original;
  if (!fs::exists(original.path() / "store.sqlite")) fill_store(original.path() / "store.sqlite");
  fs::copy(original.path(), folder.path(), fs::copy_options::recursive);
  return folder.path() / "store.sqlite";
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Overwrites a page.
void tear_page(const fs::path& file, std::size_t page) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(page * kPageBytes));
  stream << std::string(kPageBytes, '\xa5');
}

/// Every value of a saved run is that of the original; numbers of rows may be smaller.
void expect_true_values(const Store& store) {
  for (const StoredRun& run : store.runs()) {
    const std::int64_t i = run.identity.repetition;
    EXPECT_EQ(run.identity.sequence, "office");
    for (const Metric& metric : run.metrics) EXPECT_EQ(metric.value, 0.5 * static_cast<double>(i)) << run.key;
    if (run.blobs.contains("log")) {
      EXPECT_EQ(store.attachment(run, "log"), "log " + std::to_string(i));
    }
    const bool complete = run.metrics.size() == 20 && run.costs.size() == 2 && run.blobs.size() == 2 &&
                          !store.manifest(run).empty();
    EXPECT_EQ(complete, run.detail.empty()) << run.key << " " << run.detail;
  }
}

TEST(Salvage, CopiesAnIntactStoreCompletely) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  const fs::path into = folder.path() / "new.sqlite";
  const SalvageReport report = salvage_store(file, into);
  EXPECT_EQ(report.losses, std::vector<std::string>{});
  EXPECT_EQ(report.saved.at("run"), static_cast<std::size_t>(kRuns));
  EXPECT_EQ(report.saved.at("metric"), static_cast<std::size_t>(20 * kRuns));
  const Store saved(into);
  EXPECT_EQ(saved.plan_runs("p").size(), static_cast<std::size_t>(kRuns));
  EXPECT_EQ(saved.acceptances().size(), 1u);
  EXPECT_TRUE(verify_store(into).empty());
  expect_true_values(saved);
}

TEST(Salvage, SavesMostOfAStoreWithOneTornPageAtAnyPlace) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  const std::string intact = bytes_of(file);
  const std::size_t pages = intact.size() / kPageBytes;
  ASSERT_GT(pages, 40u);
  std::size_t complete = 0;
  std::size_t tested = 0;
  // The first pages contain the lists of tables and the roots of the tables.
  for (std::size_t page = 0; page < pages; page += page < 16 ? 3 : 8) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << intact;
    tear_page(file, page);
    const std::string damaged = bytes_of(file);
    const fs::path into = folder.path() / ("new" + std::to_string(page) + ".sqlite");
    const SalvageReport report = salvage_store(file, into);
    EXPECT_EQ(bytes_of(file), damaged) << "the source was changed, page " << page;
    EXPECT_TRUE(verify_store(into).empty()) << page;
    const Store saved(into);
    expect_true_values(saved);
    EXPECT_GT(saved.runs().size() + 30, static_cast<std::size_t>(kRuns)) << page;
    complete += report.losses.empty() ? 1 : 0;
    ++tested;
  }
  EXPECT_LT(complete, tested);
}

TEST(Salvage, NamesTheRunsWhoseRowsAreLost) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  const std::string key = run_key(identity_of(60));
  // The row of run 60 is on a leaf of table run; its key is also in an index.
  const std::string bytes = bytes_of(file);
  std::set<std::size_t> torn;
  for (std::size_t at = bytes.find(key); at != std::string::npos; at = bytes.find(key, at + 1)) {
    const bool is_row = bytes.compare(at + key.size(), 10, "stillpoint") == 0;
    if (is_row) torn.insert(at / kPageBytes);
  }
  ASSERT_EQ(torn.size(), 1u);
  tear_page(file, *torn.begin());
  const fs::path into = folder.path() / "new.sqlite";
  const SalvageReport report = salvage_store(file, into);
  EXPECT_NE(std::ranges::find(report.losses, "run " + key + " is lost"), report.losses.end());
  const std::size_t lost = report.losses.size();
  EXPECT_GT(lost, 1u);
  EXPECT_LT(lost, 30u);
  EXPECT_EQ(Store(into).runs().size(), kRuns - lost);
  EXPECT_TRUE(Store(into).runs({.variant = "vo"}).back().identity.repetition == kRuns);
}

TEST(Salvage, OmitsRowsWithAlteredIdentitiesAndImpossibleValues) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  {
    const Database database(file, DatabaseAccess::kWrite);
    database.execute("PRAGMA ignore_check_constraints = ON");
    database.execute("UPDATE run SET variant = 'vp' WHERE id = 1");
    database.execute("UPDATE run SET state = 'endec' WHERE id = 2");
    database.execute("UPDATE timing SET per = 'cbll' WHERE run = 3 AND module = 'solve'");
  }
  const SalvageReport report = salvage_store(file, folder.path() / "new.sqlite");
  EXPECT_EQ(report.losses,
            (std::vector<std::string>{"run " + run_key(identity_of(1)) + " is lost",
                                      "run " + run_key(identity_of(3)) + ": times of modules are lost"}));
  EXPECT_EQ(Store(folder.path() / "new.sqlite").runs().size(), static_cast<std::size_t>(kRuns - 1));
}

TEST(Salvage, NamesMissingAndDamagedFiles) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  const StoredRun run = Store(file).runs().front();
  const BlobFiles blobs(files_folder(file) / "blobs");
  fs::remove(blobs.file(run.blobs.at("log")));
  const SalvageReport report = salvage_store(file, folder.path() / "new.sqlite");
  ASSERT_EQ(report.losses.size(), 1u);
  EXPECT_TRUE(report.losses[0].starts_with("run " + run.key + ": file log (")) << report.losses[0];
  EXPECT_EQ(Store(folder.path() / "new.sqlite").attachment(run, "frames"), "same");
}

TEST(Salvage, ReadsATruncatedStore) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  fs::resize_file(file, fs::file_size(file) / 2);
  const SalvageReport report = salvage_store(file, folder.path() / "new.sqlite");
  EXPECT_GT(report.saved.at("run"), 10u);
  EXPECT_FALSE(report.losses.empty());
  expect_true_values(Store(folder.path() / "new.sqlite"));
}

TEST(Salvage, RejectsWhatIsNoStoreAndExistingOutputs) {
  const TemporaryFolder folder;
  const fs::path into = folder.path() / "new.sqlite";
  const fs::path text = folder.write("notes.txt", std::string(20000, 'n'));
  expect_input_error([&] { salvage_store(text, into); }, {"notes.txt", "nothing that can be read"});
  const fs::path other = folder.path() / "other.sqlite";
  Database(other, DatabaseAccess::kWrite).execute("CREATE TABLE holiday (day TEXT)");
  expect_input_error([&] { salvage_store(other, into); }, {"another program's database"});
  expect_input_error([&] { salvage_store(folder.path() / "none", into); }, {"no such store"});
  expect_input_error([&] { salvage_store(text, text); }, {"already exists"});
  EXPECT_FALSE(fs::exists(into));
}

TEST(StoreMaintenance, VerifyListsTheFaultsOfATornPage) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  for (std::size_t page = 1; page < 30; ++page) {
    const std::string intact = bytes_of(file);
    tear_page(file, page);
    EXPECT_FALSE(verify_store(file).empty()) << page;
    std::ofstream(file, std::ios::binary | std::ios::trunc) << intact;
  }
}

TEST(ReadableFiles, RemovesDamagedFilesFromTheRunsAndNamesThem) {
  const TemporaryFolder folder;
  const fs::path file = make_store(folder);
  const Store store(file);
  const StoredRun run = store.runs().front();
  std::ofstream(BlobFiles(files_folder(file) / "blobs").file(run.blobs.at("log")), std::ios::trunc) << "x";
  const ReadableRuns readable = without_unreadable_files(store, store.runs());
  ASSERT_EQ(readable.gaps.size(), 1u);
  EXPECT_EQ(readable.gaps[0], "run " + run.key + " (office, vo): missing or damaged files: log");
  EXPECT_EQ(readable.runs[0].detail, "missing or damaged files: log");
  EXPECT_EQ(store.attachment(readable.runs[0], "log"), "");
  EXPECT_EQ(store.attachment(readable.runs[0], "frames"), "same");
}

}  // namespace
}  // namespace stillpoint::bench
