// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_verification.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/unit/loop/random_features.h"

namespace stillpoint {
namespace {

const Camera kCamera{.width = 640, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 320.0, .cy = 240.0};
const Pose kT_m_q{exp_so3({0.05, -0.2, 0.1}), {0.4, -0.1, 0.2}};

std::vector<PointPair> pairs_of(const std::vector<KeyframeFeature>& features, double outlier_ratio,
                                std::mt19937_64& random) {
  std::vector<PointPair> pairs;
  for (const KeyframeFeature& feature : features) {
    const Eigen::Vector3d p_m = feature.p_c.cast<double>();
    pairs.push_back({kT_m_q.inverse() * p_m, p_m});
  }
  const auto outliers = static_cast<std::size_t>(outlier_ratio * static_cast<double>(pairs.size()));
  for (std::size_t i = 0; i < outliers; ++i) pairs[i].p_q = pairs[random() % pairs.size()].p_m;
  return pairs;
}

TEST(RelativePoseEstimation, FindsThePoseAmongHalfOutliers) {
  std::mt19937_64 random(1);
  const auto estimate = estimate_relative_pose(pairs_of(random_features(120, random), 0.5, random), {});
  ASSERT_TRUE(estimate);
  EXPECT_LT((estimate->T_m_q.p - kT_m_q.p).norm(), 1e-4);
  EXPECT_LT(estimate->T_m_q.q.angularDistance(kT_m_q.q), 1e-4);
  EXPECT_GE(estimate->inliers.size(), 60u);
  EXPECT_LE(estimate->inliers.size(), 63u);
}

TEST(RelativePoseEstimation, IsDeterministicForASeed) {
  std::mt19937_64 random(2);
  const std::vector<PointPair> pairs = pairs_of(random_features(100, random), 0.4, random);
  const auto a = estimate_relative_pose(pairs, {.seed = 5});
  const auto b = estimate_relative_pose(pairs, {.seed = 5});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->T_m_q.p, b->T_m_q.p);
  EXPECT_EQ(a->inliers, b->inliers);
}

TEST(RelativePoseEstimation, RefusesTooFewPairs) {
  std::mt19937_64 random(3);
  EXPECT_FALSE(estimate_relative_pose(pairs_of(random_features(3, random), 0.0, random), {}));
}

TEST(LoopVerification, AcceptsTheSamePointsFromAnotherPose) {
  std::mt19937_64 random(4);
  const Pose T_b_c{exp_so3({-1.5, 0.0, -1.5}), {0.1, 0.0, 0.05}};
  const Keyframe match{.frame = 3, .T_b_c = T_b_c, .features = random_features(200, random)};
  const Keyframe query{.frame = 90, .T_b_c = T_b_c, .features = revisited(match.features, kT_m_q, random)};
  const VerifiedLoop loop = verify_loop(query, match, kCamera, {});
  EXPECT_EQ(loop.record.outcome, LoopOutcome::kAccepted);
  EXPECT_LT((loop.record.T_match_query.p - kT_m_q.p).norm(), 1e-4);
  EXPECT_LT(((T_b_c.inverse() * loop.T_bm_bq * T_b_c).p - kT_m_q.p).norm(), 1e-4);
}

TEST(LoopVerification, RefusesUnrelatedPoints) {
  std::mt19937_64 random(5);
  const Keyframe match{.frame = 3, .features = random_features(200, random)};
  const Keyframe query{.frame = 90, .features = random_features(200, random)};
  EXPECT_EQ(verify_loop(query, match, kCamera, {}).record.outcome, LoopOutcome::kFewMatches);
}

TEST(LoopVerification, RefusesInliersOnASmallPartOfTheImage) {
  std::mt19937_64 random(6);
  Keyframe match{.frame = 3, .features = random_features(200, random)};
  for (KeyframeFeature& feature : match.features) feature.p_c.head<2>() *= 0.1F;
  const Keyframe query{.frame = 90, .features = revisited(match.features, {}, random)};
  EXPECT_EQ(verify_loop(query, match, kCamera, {}).record.outcome, LoopOutcome::kSpread);
}

/// The points on a wall at the distance `z_m`.
std::vector<KeyframeFeature> wall(std::vector<KeyframeFeature> features, float z_m) {
  for (KeyframeFeature& feature : features) feature.p_c *= 0.4F * z_m / feature.p_c.z();
  for (KeyframeFeature& feature : features) feature.p_c.z() = z_m;
  return features;
}

TEST(LoopVerification, RefusesAPoseThatIsNotCertainToFiveCentimeters) {
  // 40 points on the middle of a wall; at 4 m a rotation can hardly be distinguished from a translation.
  std::mt19937_64 random(7);
  const std::vector<KeyframeFeature> features = random_features(40, random);
  const auto outcome_at = [&](float z_m) {
    const Keyframe match{.frame = 3, .features = wall(features, z_m)};
    const Keyframe query{.frame = 90, .features = revisited(match.features, kT_m_q, random)};
    return verify_loop(query, match, kCamera, {.min_inliers = 30}).record.outcome;
  };
  EXPECT_EQ(outcome_at(1.5F), LoopOutcome::kAccepted);
  EXPECT_EQ(outcome_at(4.0F), LoopOutcome::kUncertain);
}

}  // namespace
}  // namespace stillpoint
