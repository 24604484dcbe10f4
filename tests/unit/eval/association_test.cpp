// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/association.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "eval/trajectory/pose_matches.h"

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
        expected.push_back({static_cast<PoseIndex>(ms / 10), static_cast<PoseIndex>(est.poses.size() - 1)});
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

/// Poses on a spiral from `begin_s` on, one per `interval_s`.
Trajectory spiral(double begin_s, double interval_s, int count) {
  Trajectory path;
  for (int i = 0; i < count; ++i) {
    const double t = begin_s + interval_s * i;
    path.poses.push_back(
        {from_seconds(t),
         {Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * t, Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0)),
          {std::cos(t), std::sin(t), 0.1 * t}}});
  }
  return path;
}

void expect_equal(const MatchedPose& a, const MatchedPose& b) {
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.gt.q.coeffs(), b.gt.q.coeffs());
  EXPECT_EQ(a.gt.p, b.gt.p);
  EXPECT_EQ(a.est.q.coeffs(), b.est.q.coeffs());
  EXPECT_EQ(a.est.p, b.est.p);
}

TEST(PoseMatches, GroundTruthIsInterpolatedBetweenItsPoses) {
  // Estimates at 1.05, 1.12, 1.19 s; between the poses at 1.0 and 1.1 s the first lies at half of the way.
  const Trajectory gt = spiral(1.0, 0.1, 20);
  const Trajectory est = spiral(1.05, 0.07, 10);
  const PoseMatches matches(gt, est, associate_interpolated(gt, est, 0.11));
  ASSERT_EQ(matches.size(), 10U);
  const Pose middle = interpolate(gt.poses[0].T_w_f, gt.poses[1].T_w_f, 0.5);
  EXPECT_TRUE(matches[0].gt.p.isApprox(middle.p, 1e-12));
  EXPECT_NEAR(matches[0].gt.q.angularDistance(middle.q), 0.0, 1e-7);
  expect_equal(matches[0], {est.poses[0].t, matches[0].gt, est.poses[0].T_w_f});
}

TEST(PoseMatches, AtCommonStampsThePosesAreThoseOfTheFiles) {
  const Trajectory gt = spiral(1.0, 0.1, 20);
  const Trajectory est = spiral(1.1, 0.2, 5);
  const PoseMatches interpolated(gt, est, associate_interpolated(gt, est, 0.11));
  const PoseMatches paired(gt, est, associate_tum(gt, est));
  ASSERT_EQ(interpolated.size(), 5U);
  ASSERT_EQ(paired.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    expect_equal(interpolated[i], {est.poses[i].t, gt.poses[2 * i + 1].T_w_f, est.poses[i].T_w_f});
    expect_equal(paired[i], interpolated[i]);
  }
}

TEST(PoseMatches, AlignmentAndShiftApplyToTheEstimate) {
  const Trajectory gt = spiral(1.0, 0.1, 20);
  PoseMatches matches(gt, gt, associate_interpolated(gt, gt, 0.11));
  const Similarity S_w_v{{Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}}, 2.0};
  matches.align(S_w_v);
  matches.shift(0.25);
  EXPECT_EQ(matches[3].t, from_seconds(1.55));
  EXPECT_EQ(matches.time(3), from_seconds(1.55));
  const Eigen::Vector3d expected = 2.0 * gt.poses[3].T_w_f.p + Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_TRUE(matches[3].est.p.isApprox(expected, 1e-12));
  EXPECT_EQ(matches[3].gt.p, gt.poses[3].T_w_f.p);
}

TEST(MatchView, TheFirstMatchesOfStructsAndOfIndicesAreEqual) {
  const Trajectory gt = spiral(1.0, 0.1, 20);
  const Trajectory est = spiral(1.03, 0.1, 10);
  const PoseMatches matches(gt, est, associate_tum(gt, est, {.max_difference_s = 0.04}));
  const std::vector<MatchedPose> structs =
      matched_poses(gt, est, associate_tum(gt, est, {.max_difference_s = 0.04}));
  std::size_t i = 0;
  for (const MatchedPose& match : MatchView(matches).first(4)) expect_equal(match, structs[i++]);
  EXPECT_EQ(i, 4U);
}

}  // namespace
}  // namespace stillpoint::eval
