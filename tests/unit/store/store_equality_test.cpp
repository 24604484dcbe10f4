// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/maintenance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/store/store_writer.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

RunIdentity identity_of(const std::string& variant) { return {.variant = variant, .sequence = "office"}; }

RunOutcome outcome() {
  return {.metrics = {{"ate_rmse_m", "r", "m", 0.5}, {"wall_s", "", "s", 1.0}},
          .costs = {{"window_solve", "call", 3, 1.0, 1.0, 2.0, 3.0}},
          .attachments = {{"trajectory", "0 0 0 0 0 0 0 1\n"}, {"log", "log"}},
          .manifest = R"({"host": "a", "started": "t", "seed": 1})"};
}

fs::path store_of(const TemporaryFolder& folder, const std::string& name, const RunOutcome& result) {
  fs::path file = folder.path() / name;
  StoreWriter writer(file);
  static_cast<void>(writer.acquire(identity_of("a")));
  writer.finish(identity_of("a"), result);
  return file;
}

/// Differences between a store with `outcome()` and one with a changed outcome.
template <class Change>
std::vector<std::string> differences_after(const Change& change) {
  const TemporaryFolder folder;
  RunOutcome changed = outcome();
  change(changed);
  return store_differences(store_of(folder, "a.sqlite", outcome()), store_of(folder, "b.sqlite", changed));
}

TEST(StoreEquality, StoresThatDifferInTimesHostsAndLogsAreEqual) {
  EXPECT_TRUE(differences_after([](RunOutcome& run) {
                run.metrics[1].value = 2.0;
                run.costs[0].mean_ms = 5.0;
                run.attachments["log"] = "another log";
                run.manifest = R"({"host": "b", "started": "u", "seed": 1})";
              }).empty());
}

TEST(StoreEquality, TheLastBitOfAMetricIsADifference) {
  EXPECT_EQ(
      differences_after([](RunOutcome& run) { run.metrics[0].value = std::nextafter(0.5, 1.0); }).size(), 1u);
}

TEST(StoreEquality, TrajectoryOutcomeAndManifestAreCompared) {
  EXPECT_EQ(differences_after([](RunOutcome& run) { run.attachments["trajectory"] = "x"; }).size(), 1u);
  EXPECT_EQ(differences_after([](RunOutcome& run) { run.outcome = Outcome::kCrashed; }).size(), 1u);
  EXPECT_EQ(differences_after([](RunOutcome& run) { run.manifest = R"({"seed": 2})"; }).size(), 1u);
  EXPECT_EQ(differences_after([](RunOutcome& run) { run.attachments.erase("trajectory"); }).size(), 1u);
}

TEST(StoreEquality, RunsAndPlansOfOnlyOneStoreAreListed) {
  const TemporaryFolder folder;
  const fs::path first = store_of(folder, "a.sqlite", outcome());
  const fs::path second = folder.path() / "b.sqlite";
  StoreWriter(second).record_plan({.name = "p", .title = "", .text = "", .run_keys = {}});
  const std::vector<std::string> lines = store_differences(first, second);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NE(lines[0].find("(office a): only in " + first.string()), std::string::npos) << lines[0];
  EXPECT_EQ(lines[1], "store: plan p: missing and \"\n\"");
}

}  // namespace
}  // namespace stillpoint::bench
