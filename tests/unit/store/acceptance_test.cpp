// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/store.h"

#include <gtest/gtest.h>

#include "bench/store/maintenance/maintenance.h"
#include "bench/store/maintenance/store_export.h"
#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

const Acceptance kFaster{.commit = "abc",
                         .metric = "ate_rmse_m",
                         .variant = "vo",
                         .sequence = "",
                         .reason = "a \"faster\" solver; 'tis fine",
                         .accepted = "2026-01-01T00:00:00Z"};

/// A store with one run.
fs::path small_store(const TemporaryFolder& folder, const std::string& name) {
  fs::path file = folder.path() / name;
  StoreWriter writer(file);
  const RunIdentity identity{.variant = "vo", .sequence = "office"};
  static_cast<void>(writer.acquire(identity));
  writer.finish(identity, {.metrics = {{"ate_rmse_m", "r", "m", 0.5}}});
  return file;
}

TEST(Acceptances, AreStoredAndReplacedBySubject) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder, "s");
  write_acceptances(file, {kFaster});
  Acceptance again = kFaster;
  again.reason = "another";
  Acceptance other = kFaster;
  other.variant = "";
  write_acceptances(file, {again, other});
  const std::vector<Acceptance> stored = Store(file).acceptances();
  ASSERT_EQ(stored.size(), 2u);
  EXPECT_EQ(stored[0].variant, "");
  EXPECT_EQ(stored[1].reason, "another");
}

TEST(Acceptances, CanBeWithdrawn) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder, "s");
  write_acceptances(file, {kFaster});
  EXPECT_TRUE(withdraw_acceptance(file, kFaster));
  EXPECT_FALSE(withdraw_acceptance(file, kFaster));
  EXPECT_TRUE(Store(file).acceptances().empty());
}

TEST(Acceptances, DoNotCreateAStore) {
  const TemporaryFolder folder;
  expect_input_error([&] { write_acceptances(folder.path() / "none", {kFaster}); }, {"no such store"});
  EXPECT_FALSE(fs::exists(folder.path() / "none"));
}

TEST(Acceptances, AreMergedAndImportedWithTheRuns) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder, "s");
  write_acceptances(file, {kFaster});
  static_cast<void>(merge_stores(file, folder.path() / "merged"));
  static_cast<void>(import_store(export_store(file), "text", folder.path() / "imported"));
  for (const char* name : {"merged", "imported"}) {
    const std::vector<Acceptance> stored = Store(folder.path() / name).acceptances();
    ASSERT_EQ(stored.size(), 1u) << name;
    EXPECT_EQ(stored.front().reason, kFaster.reason);
    EXPECT_EQ(stored.front().accepted, kFaster.accepted);
  }
}

TEST(Acceptances, AreImportedFromAFileWithoutRuns) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder, "s");
  constexpr const char* kText =
      R"({"stillpoint_store": 1, "plans": [], "runs": [], "accepted": [{"commit": "abc", "metric": "m", "variant": "",
          "sequence": "", "reason": "why", "accepted": "2026-01-31T12:00:00Z"}]})";
  EXPECT_EQ(import_store(kText, "text", file).added, 0u);
  ASSERT_EQ(Store(file).acceptances().size(), 1u);
  EXPECT_EQ(Store(file).acceptances().front().reason, "why");
}

}  // namespace
}  // namespace stillpoint::bench
