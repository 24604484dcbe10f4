// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/association.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace stillpoint::eval {
namespace {

Trajectory at_milliseconds(std::initializer_list<int> stamps) {
  Trajectory trajectory;
  for (const int ms : stamps) trajectory.poses.push_back({Timestamp{ms * 1'000'000LL}, Pose{}});
  return trajectory;
}

TEST(AssociateTum, MatchesTheClosestPairFirstAndEachPoseOnce) {
  // |14 - 13| = 1 ms < |10 - 13| = 3 ms, so 14 is matched with 13. The only estimate left for 10 is 40, which
  // is 30 ms away.
  const auto pairs = associate_tum(at_milliseconds({10, 14}), at_milliseconds({13, 40}));
  EXPECT_EQ(pairs, (std::vector<IndexPair>{{1, 0}}));
}

TEST(AssociateTum, MatchesPosesThatBecomeNeighborsWhenTheInnerPairIsRemoved) {
  // The inner pair (ground truth 14, estimate 13) is matched first, then ground truth 10 and estimate 16.
  const auto pairs = associate_tum(at_milliseconds({10, 14}), at_milliseconds({13, 16}));
  EXPECT_EQ(pairs, (std::vector<IndexPair>{{1, 0}, {0, 1}}));
}

TEST(AssociateTum, PrefersTheClosestPairToTheOrderOfTime) {
  // 33 is nearer to 30 (3 ms) than 20 is (10 ms), so 20 is matched with 5; in order of time it would be 30.
  const auto pairs = associate_tum(at_milliseconds({20, 33}), at_milliseconds({5, 30}));
  EXPECT_EQ(pairs, (std::vector<IndexPair>{{0, 0}, {1, 1}}));
}

TEST(AssociateInterpolated, FindsTheNeighborsAtAnyDistance) {
  // Steps of 1 to 400 poses between estimates, before, between, at and after those of the ground truth.
  Trajectory gt;
  for (int i = 0; i < 1000; ++i) gt.poses.push_back({Timestamp{i * 10'000'000LL}, Pose{}});
  for (const int step_ms : {1, 7, 10, 33, 250, 4000}) {
    Trajectory est;
    std::vector<IndexPair> expected;
    for (int ms = -45; ms < 10'100; ms += step_ms) {
      est.poses.push_back({Timestamp{ms * 1'000'000LL}, Pose{}});
      if (ms >= 0 && ms <= 9990)
        expected.push_back({static_cast<std::size_t>(ms / 10), est.poses.size() - 1});
    }
    std::vector<IndexPair> found;
    for (const InterpolatedPair& pair : associate_interpolated(gt, est, 0.5))
      found.push_back({pair.gt, pair.est});
    EXPECT_EQ(found, expected) << step_ms;
  }
}

TEST(AssociateTum, AcceptsStampsWithoutPoses) {
  const std::vector<Timestamp> gt{{20'000'000}, {30'000'000}};
  const std::vector<Timestamp> est{{29'000'000}};
  EXPECT_EQ(associate_tum(gt, est), (std::vector<IndexPair>{{1, 0}}));
}

TEST(AssociateTum, ExcludesADifferenceEqualToTheLimit) {
  EXPECT_TRUE(associate_tum(at_milliseconds({0}), at_milliseconds({20})).empty());
  EXPECT_EQ(associate_tum(at_milliseconds({1}), at_milliseconds({20})).size(), 1u);
}

TEST(AssociateTum, AddsTheOffsetToTheEstimate) {
  const auto pairs = associate_tum(at_milliseconds({1000}), at_milliseconds({0}), {.offset_s = 1.0});
  EXPECT_EQ(pairs.size(), 1u);
}

TEST(AssociateTum, ReturnsNoPairsForEmptyInput) {
  EXPECT_TRUE(associate_tum(Trajectory{}, Trajectory{}).empty());
  EXPECT_TRUE(associate_tum(Trajectory{}, at_milliseconds({1})).empty());
}

TEST(AssociateInterpolated, ReturnsTheFractionOfTheIntervalAndSkipsGaps) {
  // Ground truth at 0, 100, 1100 ms. 25 is a quarter of the first interval; 600 is 0.5 s from both neighbors,
  // which is not below the limit; 1100 is the last pose itself; 1101 is outside.
  const auto pairs =
      associate_interpolated(at_milliseconds({0, 100, 1100}), at_milliseconds({25, 600, 1100, 1101}), 0.5);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].est, 0u);
  EXPECT_DOUBLE_EQ(pairs[0].fraction, 0.25);
  EXPECT_EQ(pairs[1].gt, 2u);
  EXPECT_EQ(pairs[1].est, 2u);
}

}  // namespace
}  // namespace stillpoint::eval
