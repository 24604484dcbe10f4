// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

TEST(ReportCommand, WritesThePageAndItsTables) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "s.sqlite";
  {
    bench::StoreWriter writer(file);
    const bench::RunIdentity identity{.variant = "vo", .sequence = "a"};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.5}}});
  }
  const fs::path out = folder.path() / "out";
  EXPECT_EQ(run_program({"report", file.string(), "--out", out.string()}).exit_code, 0);
  EXPECT_TRUE(fs::exists(out / "index.html"));
  for (const char* name : {"ate_rmse_m.md", "ate_rmse_m.tex", "ate_rmse_m.csv", "ate_rmse_m.json"})
    EXPECT_TRUE(fs::exists(out / "tables" / name)) << name;
}

/// Executes a plan with one run on the rendered sequence.
bench::StoredRun run_of_plan(const TemporaryFolder& folder, const std::string& settings) {
  const std::string sequence = rendered_sequence().filename().string();
  const fs::path plan = folder.write(
      "plan.toml", settings + "[recorded]\nsequences = [\"" + sequence + "\"]\nvariants = [\"vo\"]\n");
  const ProgramResult result =
      run_program({"bench", plan.string(), "--out", folder.path().string(), "--store",
                   (folder.path() / "store.sqlite").string()},
                  {.environment = {"STILLPOINT_DATA=" + rendered_sequence().parent_path().string()}});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return bench::Store(folder.path() / "store.sqlite").runs().back();
}

std::size_t image_count(const bench::StoredRun& run) {
  std::size_t images = 0;
  for (const auto& [kind, blob] : run.blobs) images += kind.starts_with(bench::kImageKind) ? 1 : 0;
  return images;
}

TEST(ReportCommand, ContainsTheStoredImagesAndStacks) {
  const TemporaryFolder folder;
  const bench::StoredRun run = run_of_plan(folder, "images = 2\n");
  EXPECT_EQ(image_count(run), 2u);
  const fs::path store = folder.path() / "store.sqlite";
  ASSERT_EQ(run_program({"report", store.string(), "--out", folder.path().string()}).exit_code, 0);
  std::ifstream file(folder.path() / "index.html");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find("\"/9j/"), std::string::npos);  // first bytes of a JPEG in base64
  EXPECT_NE(page.find("tracking;tracking_thread;feature_tracking"), std::string::npos);
}

TEST(BenchCommand, StoresNoImagesOfTimingRuns) {
  const TemporaryFolder folder;
  EXPECT_EQ(image_count(run_of_plan(folder, "images = 2\nkind = \"timing\"\n")), 0u);
}

/// A store with two runs, and a file for each.
fs::path store_with_files(const TemporaryFolder& folder) {
  fs::path file = folder.path() / "s.sqlite";
  bench::StoreWriter writer(file);
  for (const char* variant : {"vo", "vio"}) {
    const bench::RunIdentity identity{.variant = variant, .sequence = "a"};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.5}},
                             .attachments = {{"frames", std::string("frames of ") + variant}}});
  }
  return file;
}

TEST(ReportCommand, WritesThePageOfAStoreWithAMissingFileAndNamesTheGap) {
  const TemporaryFolder folder;
  const fs::path file = store_with_files(folder);
  const bench::StoredRun run = bench::Store(file).runs().front();
  fs::remove(bench::BlobFiles(bench::files_folder(file) / "blobs").file(run.blobs.at("frames")));
  const ProgramResult result =
      run_program({"report", file.string(), "--out", (folder.path() / "out").string()});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const std::string gap = "run " + run.key + " (a, vo): missing or damaged files: frames";
  EXPECT_NE(result.err.find("warning: " + gap), std::string::npos) << result.err;
  std::ifstream page(folder.path() / "out" / "index.html");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(text.find("<li class=\"gap\">" + gap), std::string::npos);
}

TEST(StoreSalvage, PrintsWhatIsSavedAndLost) {
  const TemporaryFolder folder;
  const fs::path file = store_with_files(folder);
  const std::string out = (folder.path() / "new.sqlite").string();
  const ProgramResult intact = run_program({"store", "salvage", file.string(), out});
  EXPECT_EQ(intact.exit_code, 0) << intact.err;
  EXPECT_NE(intact.out.find("nothing is lost"), std::string::npos) << intact.out;
  EXPECT_EQ(run_program({"store", "salvage", file.string(), out}).exit_code, 2);  // exists
  fs::remove_all(bench::files_folder(file) / "blobs");
  const ProgramResult damaged = run_program({"store", "salvage", file.string(), out + "2"});
  EXPECT_EQ(damaged.exit_code, 1) << damaged.err;
  EXPECT_NE(damaged.out.find("2 losses"), std::string::npos) << damaged.out;
}

TEST(StoreExport, NeverReplacesTheStoreOrOtherFiles) {
  const TemporaryFolder folder;
  const std::string store = store_with_files(folder).string();
  const std::string notes = folder.write("notes.json", "{}").string();
  const auto exported = [&](const std::string& file, bool force) {
    std::vector<std::string> arguments = {"store", "export", file, "--store", store};
    if (force) arguments.emplace_back("--force");
    return run_program(arguments).exit_code;
  };
  EXPECT_EQ(exported(store, true), 2);
  EXPECT_EQ(exported(notes, true), 2);
  const std::string file = (folder.path() / "export.json").string();
  EXPECT_EQ(exported(file, false), 0);
  EXPECT_EQ(exported(file, false), 2);
  EXPECT_EQ(exported(file, true), 0);
  EXPECT_EQ(bench::Store(store).runs().size(), 2u);
}

TEST(StoreExtract, DoesNotReplaceForeignFiles) {
  const TemporaryFolder folder;
  const std::string store = store_with_files(folder).string();
  const std::string key = bench::Store(store).runs().front().key;
  folder.write("mine/manifest.json", "{}");
  const auto extract = [&](const std::string& name) {
    return run_program({"store", "extract", key, (folder.path() / name).string(), "--store", store})
        .exit_code;
  };
  EXPECT_EQ(extract("mine"), 2);
  EXPECT_EQ(extract("new"), 0);
  EXPECT_EQ(extract("new"), 0);  // an earlier output of the same run
}

TEST(ReportCommand, DoesNotReplaceAForeignPage) {
  const TemporaryFolder folder;
  const std::string store = store_with_files(folder).string();
  folder.write("site/index.html", "my site");
  for (const char* command : {"report", "dashboard"}) {
    const ProgramResult result = run_program({command, store, "--out", (folder.path() / "site").string()});
    EXPECT_EQ(result.exit_code, 2) << command;
    EXPECT_NE(result.err.find("index.html: exists, but not as part"), std::string::npos) << result.err;
  }
}

TEST(ReportCommand, TakesTheStoreAsAnOptionToo) {
  const std::vector<std::vector<std::string>> commands = {
      {"report", "--out", "page"}, {"dashboard", "--out", "page"}, {"regressions"}, {"serve"}};
  for (std::vector<std::string> arguments : commands) {
    arguments.insert(arguments.end(), {"--store", "missing.sqlite"});
    EXPECT_NE(run_program(arguments).err.find("missing.sqlite: there is no such store"), std::string::npos)
        << arguments.front();
  }
}

TEST(ReportCommand, RejectsAMissingStore) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program({"report", (folder.path() / "none").string(), "--out", folder.path().string()});
  EXPECT_EQ(result.exit_code, 2);
}

TEST(ReproduceCommand, ReportsMissingDataAndWritesTheTable) {
  const TemporaryFolder folder;
  const std::string empty = folder.path().string();
  const ProgramResult result =
      run_program({"reproduce", "table2", "--real", "--store", empty + "/s", "--out", empty},
                  {.environment = {"STILLPOINT_DATA=" + empty, "STILLPOINT_REGISTRY=" + empty + "/none"}});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("stillpoint data get"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder.path() / "table2.tex"));
}

TEST(ReproduceCommand, ListsTheTargetsForAnUnknownOne) {
  const ProgramResult result = run_program({"reproduce", "table9"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("table1, table2, table3"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
