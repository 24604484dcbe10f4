// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/slam_system.h"

#include <gtest/gtest.h>

#include "bench/store/store.h"
#include "bench/store/store_writer.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

// Ctrl-C of the worker is handled by the worker, which releases the run. A run that another process
// interrupted has no complete results: it counts as crashed, which stores accept.
TEST(OwnOdometry, StoresARunThatAnotherProcessInterruptedAsCrashed) {
  const TemporaryFolder folder;
  folder.write("result.json", R"({"status": "interrupted", "failure": "interrupted after 3 of 10 frames",)"
                              R"( "timings": {"modules": {}, "threads": {}}})");
  folder.write("manifest.json", "{}");
  RunRequest request;
  request.identity = {.variant = "stillpoint", .sequence = "toy"};
  request.work = folder.path();

  const RunOutcome outcome = OwnOdometry().outcome(request, {.exit_code = 130});

  EXPECT_EQ(outcome.outcome, Outcome::kCrashed);
  EXPECT_EQ(outcome.detail, "interrupted after 3 of 10 frames");
  StoreWriter writer(folder.path() / "store.sqlite");
  ASSERT_EQ(writer.acquire(request.identity), RunLease::kGranted);
  EXPECT_NO_THROW(writer.finish(request.identity, outcome));
}

// A commit that is dated before its parent has the time of the parent, see `SourceBuilds::commits`.
TEST(OwnOdometry, StoresTheTimeOfTheCommitThatTheHistoryStates) {
  const TemporaryFolder folder;
  folder.write("result.json",
               R"({"status": "ok", "failure": null, "timings": {"modules": {}, "threads": {}}})");
  folder.write(
      "manifest.json",
      R"({"build": {"git_commit": "c0ffee", "git_time": "2024-01-01T00:20:00Z"}, "started": "now"})");
  RunRequest request;
  request.work = folder.path();
  const std::string own = OwnOdometry().outcome(request, {}).manifest;
  EXPECT_NE(own.find("2024-01-01T00:20:00Z"), std::string::npos) << own;
  request.commit_time = "2024-01-01T00:40:00Z";
  const std::string stored = OwnOdometry().outcome(request, {}).manifest;
  EXPECT_NE(stored.find("\"git_time\": \"2024-01-01T00:40:00Z\""), std::string::npos) << stored;
  EXPECT_NE(stored.find("\"git_commit\": \"c0ffee\""), std::string::npos) << stored;
}

// As of a damaged image in the cache of renderings: the run succeeds without it.
TEST(OwnOdometry, NamesImagesThatCouldNotBeRead) {
  const TemporaryFolder folder;
  folder.write(
      "result.json",
      R"({"status": "ok", "failure": null, "timings": {"modules": {}, "threads": {}}, "skipped_frames":)"
      R"( [{"index": 3, "reason": "rgb/3.png: is damaged"}, {"index": 4, "reason": "rgb/4.png"}]})");
  folder.write("manifest.json", "{}");
  RunRequest request;
  request.work = folder.path();
  EXPECT_EQ(OwnOdometry().outcome(request, {}).detail,
            "2 frames could not be read, the first: rgb/3.png: is damaged");
  request.fault = "drop";
  EXPECT_EQ(OwnOdometry().outcome(request, {}).detail, "");
}

}  // namespace
}  // namespace stillpoint::bench
