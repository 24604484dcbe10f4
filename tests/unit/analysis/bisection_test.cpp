// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/search/bisection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

TEST(BisectVersions, FindsEachChangeInLogarithmicallyManySteps) {
  for (std::size_t count = 2; count < 40; ++count) {
    for (std::size_t first = 1; first < count; ++first) {
      std::size_t calls = 0;
      const Bisection found = bisect_versions(count, [&](std::size_t version) {
        ++calls;
        return version < first ? VersionSide::kBefore : VersionSide::kAfter;
      });
      EXPECT_EQ(found.first_after, first);
      EXPECT_TRUE(found.is_single());
      EXPECT_LE(static_cast<double>(calls), std::ceil(std::log2(static_cast<double>(count) - 1.0)));
    }
  }
}

// 5 cannot be tested: the change of 6 or later is found beside it, that of 5 or 6 is in one of both.
TEST(BisectVersions, LeavesOutVersionsThatCannotBeTested) {
  const auto search = [](std::size_t first) {
    return bisect_versions(12, [&](std::size_t version) {
      if (version == 5) return VersionSide::kUntestable;
      return version < first ? VersionSide::kBefore : VersionSide::kAfter;
    });
  };
  EXPECT_EQ(search(8).first_after, 8u);
  EXPECT_TRUE(search(8).is_single());
  for (const std::size_t first : {5u, 6u}) {
    EXPECT_EQ(search(first).last_before, 4u);
    EXPECT_EQ(search(first).first_after, 6u);
    EXPECT_FALSE(search(first).is_single());
  }
}

std::vector<StoredRun> replicates(const std::string& build, double ate_m, double scatter, int count) {
  std::vector<StoredRun> runs;
  for (int i = 1; i <= count; ++i)
    runs.push_back(compared_run("a", ate_m * (1.0 + scatter * std::sin(7.0 * i + 10.0 * ate_m)), i, build));
  return runs;
}

Comparison compared(double ate_m, int count) {
  return compare_runs(replicates("base", 1.0, 0.01, count), replicates("head", ate_m, 0.01, count),
                      CompareSource::kPrograms);
}

TEST(SideOfVersion, IsTheHalfOfTheWholeChange) {
  const std::optional<FollowedChange> whole = followed_change(compared(2.0, 8), "ate_rmse_m");
  ASSERT_TRUE(whole);
  EXPECT_NEAR(whole->change.change.median, 1.0, 0.05);
  EXPECT_EQ(side_of(compared(1.02, 8), *whole), VersionSide::kBefore);
  EXPECT_EQ(side_of(compared(1.9, 8), *whole), VersionSide::kAfter);
  EXPECT_EQ(side_of(compared(1.9, 2), *whole), VersionSide::kUndecided);  // no interval
  EXPECT_EQ(side_of(compared(1.0, 8), *whole), VersionSide::kBefore);     // bit-equal
  EXPECT_FALSE(followed_change(compared(1.001, 8), "ate_rmse_m"));
  EXPECT_FALSE(followed_change(compared(2.0, 8), "coverage"));
}

std::vector<StoredRun> with_failures(int count, int every) {
  std::vector<StoredRun> runs = replicates("head", 1.0, 0.01, count);
  for (int i = every; every > 0 && i <= count; i += every)
    runs[static_cast<std::size_t>(i - 1)].outcome = Outcome::kCrashed;
  return runs;
}

// A rate of 1/20: 0.95^32 = 0.19, 0.95^64 = 0.04.
TEST(SideOfVersion, NeedsAsManyRunsAsFailuresAreRare) {
  const auto failing = [](int count, int every) {
    return compare_runs(with_failures(count, 0), with_failures(count, every), CompareSource::kPrograms);
  };
  const std::optional<FollowedChange> whole = followed_change(failing(40, 20), "failed_runs");
  ASSERT_TRUE(whole);
  EXPECT_DOUBLE_EQ(whole->failure_rate, 0.05);
  EXPECT_EQ(side_of(failing(20, 20), *whole), VersionSide::kAfter);
  EXPECT_EQ(side_of(failing(32, 0), *whole), VersionSide::kUndecided);
  EXPECT_EQ(side_of(failing(64, 0), *whole), VersionSide::kBefore);
  EXPECT_FALSE(followed_change(failing(40, 0), "failed_runs"));
}

}  // namespace
}  // namespace stillpoint::bench
