// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include <gtest/gtest.h>

#include "bench/store/journal.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

TEST(ReportCommand, WritesThePageAndItsTables) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "s.sqlite";
  {
    Journal journal(file);
    const RunIdentity identity{.variant = "vo", .sequence = "a"};
    static_cast<void>(journal.claim(identity));
    journal.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.5}}});
  }
  const fs::path out = folder.path() / "out";
  EXPECT_EQ(run_program({"report", file.string(), "--out", out.string()}).exit_code, 0);
  EXPECT_TRUE(fs::exists(out / "index.html"));
  for (const char* name : {"ate_rmse_m.md", "ate_rmse_m.tex", "ate_rmse_m.csv", "ate_rmse_m.json"})
    EXPECT_TRUE(fs::exists(out / "tables" / name)) << name;
}

TEST(ReportCommand, RefusesWhatIsNoStore) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program({"report", (folder.path() / "none").string(), "--out", folder.path().string()});
  EXPECT_EQ(result.exit_code, 2);
}

TEST(ReproduceCommand, SaysWhatDataAreMissingAndStillWritesTheTable) {
  const TemporaryFolder folder;
  const std::string empty = folder.path().string();
  const ProgramResult result =
      run_program({"reproduce", "table2", "--real", "--store", empty + "/s", "--out", empty},
                  {.environment = {"STILLPOINT_DATA=" + empty, "STILLPOINT_REGISTRY=" + empty + "/none"}});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("stillpoint data add"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder.path() / "table2.tex"));
}

TEST(ReproduceCommand, NamesWhatThereIs) {
  const ProgramResult result = run_program({"reproduce", "table9"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("table1, table2, table3"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
