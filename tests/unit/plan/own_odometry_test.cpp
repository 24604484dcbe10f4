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

}  // namespace
}  // namespace stillpoint::bench
