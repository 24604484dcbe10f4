// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

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

TEST(DashboardCommand, ShowsSubjectsAndLinksOfCommits) {
  const TemporaryFolder folder;
  const std::string repository = (folder.path() / "r").string();
  const std::string git = "GIT_CONFIG_GLOBAL=/dev/null git -c user.name=t -c user.email=t@example.org ";
  ASSERT_EQ(std::system((git + "init -q " + repository + " && cd " + repository + " && " + git +
                         "commit -q --allow-empty --date 2024-01-02T03:04:05Z -m 'Draw <b>faster</b>' && git "
                         "rev-parse HEAD >../hash")
                            .c_str()),
            0);
  std::string hash;
  std::ifstream(folder.path() / "hash") >> hash;
  const std::string file = (folder.path() / "s.sqlite").string();
  {
    bench::StoreWriter writer(file);
    for (const std::string& build : {std::string("aaa"), hash, hash + "+0123", std::string(40, 'f')}) {
      const bench::RunIdentity identity{.variant = "vo", .sequence = "a", .build = build};
      ASSERT_EQ(writer.acquire(identity), bench::RunLease::kGranted);
      writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.5}}});
    }
  }
  const fs::path out = folder.path() / "out";
  const auto dashboard = [&](const std::string& url) {
    return run_program(
        {"dashboard", file, "--out", out.string(), "--repository", repository, "--commit-url", url});
  };
  const ProgramResult result = dashboard("https://example.org/{commit}");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  int described = 0;
  for (const auto& page : fs::directory_iterator(out / "commits")) {
    std::ifstream stream(page.path());
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (text.find("Draw &lt;b&gt;faster&lt;/b&gt;") == std::string::npos) continue;
    ++described;
    EXPECT_NE(text.find("2024-01-02T03:04:05Z"), std::string::npos);
    EXPECT_NE(text.find("href=\"https://example.org/" + hash + "\""), std::string::npos);
  }
  EXPECT_EQ(described, 2);  // the commit, and the commit with changes
  for (const char* url : {"javascript:{commit}", "https://example.org/"}) {
    const ProgramResult wrong = dashboard(url);
    EXPECT_EQ(wrong.exit_code, 2) << url;
    EXPECT_NE(wrong.err.find("--commit-url"), std::string::npos) << wrong.err;
  }
  const ProgramResult none =
      run_program({"dashboard", file, "--out", out.string(), "--repository", folder.path().string()});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("git"), std::string::npos) << none.err;
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
