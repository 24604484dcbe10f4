// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "tests/support/program.h"
#include "tests/support/rendered_sequence.h"
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
  EXPECT_NE(result.out.find("stillpoint data add"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder.path() / "table2.tex"));
}

TEST(ReproduceCommand, ListsTheTargetsForAnUnknownOne) {
  const ProgramResult result = run_program({"reproduce", "table9"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("table1, table2, table3"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
