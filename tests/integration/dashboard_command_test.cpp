// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A store of two commits, the second one with the given outcome.
fs::path store_of(const TemporaryFolder& folder, bench::Outcome second) {
  fs::path file = folder.path() / "s.sqlite";
  bench::StoreWriter writer(file);
  for (const bench::Outcome outcome : {bench::Outcome::kOk, second}) {
    const bench::RunIdentity identity{
        .variant = "vo", .sequence = "a", .build = outcome == second ? "bbb" : "aaa"};
    if (writer.acquire(identity) != bench::RunLease::kGranted) continue;
    writer.finish(identity, {.outcome = outcome, .metrics = {{"ate_rmse_m", "", "m", 0.5}}});
  }
  return file;
}

TEST(DashboardCommand, WritesTheIndexAndAPageForEachCommit) {
  const TemporaryFolder folder;
  const std::string file = store_of(folder, bench::Outcome::kLost).string();
  const fs::path out = folder.path() / "out";
  EXPECT_EQ(run_program({"dashboard", file, "--out", out.string()}).exit_code, 0);
  EXPECT_TRUE(fs::exists(out / "index.html"));
  EXPECT_TRUE(fs::exists(out / "regressions.json"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out / "commits"), fs::directory_iterator()), 2);
}

TEST(RegressionsCommand, ExitCodeReportsOpenRegressions) {
  const TemporaryFolder good;
  EXPECT_EQ(run_program({"regressions", store_of(good, bench::Outcome::kOk).string()}).exit_code, 0);
  const TemporaryFolder bad;
  const ProgramResult open = run_program({"regressions", store_of(bad, bench::Outcome::kLost).string()});
  EXPECT_EQ(open.exit_code, 1);
  EXPECT_NE(open.out.find("failed\\_runs"), std::string::npos);
  { const bench::StoreWriter empty(bad.path() / "empty"); }
  EXPECT_EQ(run_program({"regressions", (bad.path() / "empty").string()}).exit_code, 2);
  EXPECT_EQ(run_program({"regressions", (bad.path() / "none").string()}).exit_code, 2);
  EXPECT_EQ(run_program({"regressions", (bad.path() / "s.sqlite").string(), "--format", "xml"}).exit_code, 2);
}

TEST(StoreAccept, ClosesARegressionUntilTheAcceptanceIsWithdrawn) {
  const TemporaryFolder folder;
  const std::string file = store_of(folder, bench::Outcome::kLost).string();
  const std::vector<std::string> subject = {"bb", "--metric", "failed_runs", "--store", file};
  const auto store = [&](const std::string& command, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"store", command};
    arguments.insert(arguments.end(), subject.begin(), subject.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments).exit_code;
  };
  EXPECT_EQ(store("accept", {}), 2);  // no reason
  EXPECT_EQ(store("accept", {"--reason", "known", "--variant", "no_such"}), 2);
  EXPECT_EQ(store("accept", {"--reason", "known"}), 0);
  EXPECT_EQ(run_program({"regressions", file}).exit_code, 0);
  EXPECT_NE(run_program({"store", "accepted", "--store", file}).out.find("known"), std::string::npos);
  EXPECT_EQ(store("withdraw", {}), 0);
  EXPECT_EQ(run_program({"regressions", file}).exit_code, 1);
}

TEST(ServeCommand, ListensOnLoopbackUntilItIsInterrupted) {
  const TemporaryFolder folder;
  const std::string file = store_of(folder, bench::Outcome::kOk).string();
  const ProgramResult result =
      run_program({"serve", file, "--port", "0"}, {.interrupt_after = "serving http://127.0.0.1:"});
  EXPECT_EQ(result.exit_code, 0);
}

TEST(ServeCommand, WatchesAStoreWithoutRuns) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "s.sqlite").string();
  { const bench::StoreWriter empty(file); }
  EXPECT_EQ(run_program({"serve", file, "--port", "0"}).exit_code, 2);  // there is nothing to show
  const ProgramResult result = run_program({"serve", file, "--port", "0", "--watch"},
                                           {.interrupt_after = "serving http://127.0.0.1:"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

}  // namespace
}  // namespace stillpoint
