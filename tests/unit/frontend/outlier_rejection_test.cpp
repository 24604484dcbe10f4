// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/outlier_rejection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/geometry/pose.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kFocalPx = 500.0;
constexpr double kNoisePx = 0.2;

const Pose kForwardAndTurning{exp_so3({0.01, 0.02, -0.01}), {0.03, 0.01, 0.05}};
const Pose kPureRotation{exp_so3({0.02, 0.05, -0.03}), Eigen::Vector3d::Zero()};

enum class Scene { kRoom, kPlane };

std::vector<Match> static_matches(Scene scene, const Pose& T_to_from, int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> across(-0.6, 0.6);
  std::uniform_real_distribution<double> along(1.0, 6.0);
  std::normal_distribution<double> noise(0.0, kNoisePx / kFocalPx);
  std::vector<Match> matches;
  for (int i = 0; i < count; ++i) {
    Match match;
    match.from = {across(random), across(random)};
    match.depth = scene == Scene::kRoom ? along(random) : 2.0 + match.from.x();
    const Eigen::Vector3d point_from = match.depth * match.from.homogeneous();
    match.to = (T_to_from * point_from).hnormalized() + Eigen::Vector2d(noise(random), noise(random));
    matches.push_back(match);
  }
  return matches;
}

OutlierRejectionSettings settings_for(OutlierModel model) { return {.model = model, .focal_px = kFocalPx}; }

long count_fitting(const Inliers& inliers) {
  return std::count(inliers.begin(), inliers.end(), std::uint8_t{1});
}

std::vector<Match> without_depth(std::vector<Match> matches) {
  for (Match& match : matches) match.depth = 0.0;
  return matches;
}

class OutlierRejection : public testing::TestWithParam<OutlierModel> {};
INSTANTIATE_TEST_SUITE_P(Models, OutlierRejection,
                         testing::Values(OutlierModel::kEpipolar, OutlierModel::kRigid));

// Noise of 0.2 px per axis is 5 sigma below the threshold of 1 px. The epipolar model comes from a noisy
// minimal sample, so some good matches may go: 90 % must stay.
TEST_P(OutlierRejection, KeepsStaticPointsUnderAnyMotionAndScene) {
  for (const Scene scene : {Scene::kRoom, Scene::kPlane}) {
    for (const Pose& motion : {kForwardAndTurning, kPureRotation, Pose{}}) {
      const std::vector<Match> matches = static_matches(scene, motion, 100);
      EXPECT_GE(count_fitting(find_inliers(matches, settings_for(GetParam()))), 90);
    }
  }
}

TEST_P(OutlierRejection, ThrowsOutMatchesThatLeaveTheirLine) {
  std::vector<Match> matches = static_matches(Scene::kRoom, kForwardAndTurning, 100);
  // The translation lies mostly along z: lines run through the middle of the picture. Move across them.
  for (std::size_t i = 0; i < 20; ++i) {
    const Eigen::Vector2d& to = matches[i].to;
    matches[i].to += 10.0 / kFocalPx * Eigen::Vector2d(-to.y(), to.x()).normalized();
  }
  const Inliers inliers = find_inliers(matches, settings_for(GetParam()));
  EXPECT_LE(std::count(inliers.begin(), inliers.begin() + 20, std::uint8_t{1}), 2);
  EXPECT_GE(std::count(inliers.begin() + 20, inliers.end(), std::uint8_t{1}), 72);  // 90 % of 80
}

TEST_P(OutlierRejection, JudgesNothingByFewMatches) {
  std::vector<Match> matches = static_matches(Scene::kRoom, kForwardAndTurning, 7);
  matches[0].to.y() += 0.2;
  EXPECT_EQ(count_fitting(find_inliers(matches, settings_for(GetParam()))), 7);
  EXPECT_TRUE(find_inliers({}, settings_for(GetParam())).empty());
}

TEST_P(OutlierRejection, NeverWipesOutWhatHasNoCommonMotion) {
  std::vector<Match> matches = static_matches(Scene::kRoom, kForwardAndTurning, 60);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> anywhere(-0.6, 0.6);
  for (Match& match : matches) match.to = {anywhere(random), anywhere(random)};
  EXPECT_EQ(count_fitting(find_inliers(matches, settings_for(GetParam()))), 60);
}

TEST_P(OutlierRejection, GivesTheSameAnswerTwice) {
  const std::vector<Match> matches = static_matches(Scene::kRoom, kForwardAndTurning, 100);
  EXPECT_EQ(find_inliers(matches, settings_for(GetParam())), find_inliers(matches, settings_for(GetParam())));
}

TEST(RigidOutlierRejection, SeesMoversAlongTheEpipolarLine) {
  const Pose sideways{Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}};
  std::vector<Match> matches = static_matches(Scene::kRoom, sideways, 100);
  for (std::size_t i = 0; i < 30; ++i) matches[i].to.x() += 5.0 / kFocalPx;  // lines are horizontal
  const Inliers inliers = find_inliers(matches, settings_for(OutlierModel::kRigid));
  EXPECT_EQ(std::count(inliers.begin(), inliers.begin() + 30, std::uint8_t{1}), 0);
  EXPECT_GE(std::count(inliers.begin() + 30, inliers.end(), std::uint8_t{1}),
            69);  // 5 sigma: all but one in 70
  const Inliers epipolar = find_inliers(matches, settings_for(OutlierModel::kEpipolar));
  EXPECT_GT(std::count(epipolar.begin(), epipolar.begin() + 30, std::uint8_t{1}), 25);
}

TEST(RigidOutlierRejection, HoldsPointsWithoutDepthAgainstTheirLines) {
  std::vector<Match> matches = static_matches(Scene::kRoom, kForwardAndTurning, 100);
  matches[3].depth = 0.0;
  matches[4].depth = 0.0;
  matches[4].to += 10.0 / kFocalPx * Eigen::Vector2d(-matches[4].to.y(), matches[4].to.x()).normalized();
  const Inliers inliers = find_inliers(matches, settings_for(OutlierModel::kRigid));
  EXPECT_EQ(inliers[3], 1);
  EXPECT_EQ(inliers[4], 0);
}

TEST(RigidOutlierRejection, IsEpipolarWithoutDepth) {
  const std::vector<Match> matches = without_depth(static_matches(Scene::kRoom, kForwardAndTurning, 100));
  EXPECT_EQ(find_inliers(matches, settings_for(OutlierModel::kRigid)),
            find_inliers(matches, settings_for(OutlierModel::kEpipolar)));
}

}  // namespace
}  // namespace stillpoint
