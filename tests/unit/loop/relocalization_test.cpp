// SPDX-License-Identifier: BSD-3-Clause
// Relocalization in the map of an earlier run, before a textured wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "core/geometry/so3.h"
#include "core/loop/loop_closure.h"
#include "tests/unit/loop/painted_wall.h"

namespace stillpoint {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

KeyframeMap map_of(const cv::Mat& wall) {
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  for (int i = 0; i < 42; ++i) {
    const Pose T_w_c{Eigen::Quaterniond::Identity(), {1.8 + 0.3 * i, 1.5, -2.5}};
    DepartedKeyframe keyframe = keyframe_at(wall, T_w_c, i);
    keyframe.T_w_b = T_w_c;
    static_cast<void>(closure.add(keyframe));
  }
  return *closure.finish().map;
}

/// What the second run hands over.
enum class Handover { kKeyframes, kCurrentFrames };

/// A second run from a random place, whose odometry has an unknown origin and heading.
struct SecondRun {
  int frames = 0;  ///< until it was located; 0: never
  double error_m = 0.0;
  double error_deg = 0.0;
};

SecondRun second_run(const KeyframeMap& map, const cv::Mat& wall, std::mt19937_64& random,
                     Handover handover = Handover::kKeyframes) {
  const bool keyframes = handover == Handover::kKeyframes;
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Pose T_o_w{exp_so3({0.0, 0.0, 3.0 * unit(random)}),
                   10.0 * Eigen::Vector3d(unit(random), unit(random), unit(random))};
  const Eigen::Vector3d start(7.8 + 5.0 * unit(random), 1.5 + 0.15 * unit(random), -2.5 + 0.3 * unit(random));
  const Eigen::Quaterniond turn = exp_so3({0.05 * unit(random), 0.12 * unit(random), 0.05 * unit(random)});
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map);
  // Keyframes are 0.15 m apart; of the current frames, there are 8 in 0.8 s.
  for (int i = 0; i < (keyframes ? 6 : 8); ++i) {
    const Pose T_w_c{turn, start + Eigen::Vector3d((keyframes ? 0.15 : 0.03) * i, 0.0, 0.0)};
    DepartedKeyframe keyframe = keyframe_at(wall, T_w_c, i);
    keyframe.T_w_b = T_o_w * T_w_c;
    const Pose T_m_o = keyframes ? closure.add(keyframe) : closure.locate(keyframe);
    if (!closure.is_located()) continue;
    const Pose error = T_w_c.inverse() * T_m_o * keyframe.T_w_b;
    return {i + 1, error.p.norm(), error.q.angularDistance(Eigen::Quaterniond::Identity()) / kDegree};
  }
  return {};
}

TEST(Relocalization, LocatesAtLeastNinetyPercentOfRandomStartsAndNoneFalsely) {
  const cv::Mat wall = painted_wall(1);
  const KeyframeMap map = map_of(wall);
  std::mt19937_64 random(5);
  int located = 0;
  for (int start = 0; start < 50; ++start) {
    const SecondRun run = second_run(map, wall, random);
    if (run.frames == 0) continue;
    ++located;
    EXPECT_LT(run.error_m, 0.05) << start;
    EXPECT_LT(run.error_deg, 2.0) << start;
  }
  EXPECT_GE(located, 45);
}

TEST(Relocalization, CurrentFramesLocateRandomStartsWithinASecondAndNoneFalsely) {
  const cv::Mat wall = painted_wall(1);
  const KeyframeMap map = map_of(wall);
  std::mt19937_64 random(5);
  int located = 0;
  for (int start = 0; start < 50; ++start) {
    const SecondRun run = second_run(map, wall, random, Handover::kCurrentFrames);
    if (run.frames == 0) continue;
    ++located;
    EXPECT_LT(run.error_m, 0.05) << start;
    EXPECT_LT(run.error_deg, 2.0) << start;
  }
  EXPECT_GE(located, 45);
}

TEST(Relocalization, CurrentFramesOfAnotherPlaceAreNotLocated) {
  const KeyframeMap map = map_of(painted_wall(1));
  const cv::Mat other = painted_wall(2);
  std::mt19937_64 random(6);
  for (int start = 0; start < 10; ++start)
    EXPECT_EQ(second_run(map, other, random, Handover::kCurrentFrames).frames, 0);
}

TEST(Relocalization, AFrameThatFitsTwoPlacesOfTheMapIsAmbiguous) {
  cv::Mat wall = painted_wall(1);
  wall.colRange(0, 1200).copyTo(wall.colRange(1200, 2400));  // equal halves, 8 m apart
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map_of(wall));
  for (int i = 0; i < 10; ++i) {
    DepartedKeyframe frame =
        keyframe_at(wall, {Eigen::Quaterniond::Identity(), {3.0 + 0.2 * i, 1.5, -2.5}}, i);
    frame.T_w_b.p.x() = 0.2 * i;
    static_cast<void>(closure.locate(frame));
  }
  EXPECT_FALSE(closure.is_located());
  EXPECT_GT(std::ranges::count(closure.finish().loops, LoopOutcome::kPairwise, &LoopRecord::outcome), 5);
}

TEST(Relocalization, TheStartConstrainsTheFirstKeyframe) {
  const cv::Mat wall = painted_wall(1);
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map_of(wall));
  const Pose T_o_w{exp_so3({0.0, 0.0, 1.0}), {3.0, 2.0, 1.0}};
  const auto frame_at = [&](int i, double x_m) {
    const Pose T_w_c{Eigen::Quaterniond::Identity(), {x_m, 1.5, -2.5}};
    DepartedKeyframe keyframe = keyframe_at(wall, T_w_c, i);
    keyframe.T_w_b = T_o_w * T_w_c;
    return keyframe;
  };
  for (int i = 0; i < 3; ++i) static_cast<void>(closure.locate(frame_at(i, 6.0)));
  ASSERT_TRUE(closure.is_located());
  for (int i = 3; i < 9; ++i) static_cast<void>(closure.add(frame_at(i, 6.0 + 0.15 * (i - 3))));
  const LoopReport report = closure.finish();
  EXPECT_TRUE(report.relocalized);
  EXPECT_EQ(std::ranges::count_if(report.loops,
                                  [](const LoopRecord& loop) {
                                    return loop.query_frame < 3 && loop.outcome == LoopOutcome::kAccepted;
                                  }),
            1);
  for (const MapKeyframe& keyframe : report.keyframes) {
    const Eigen::Vector3d expected(6.0 + 0.15 * static_cast<double>(keyframe.frame - 3), 1.5, -2.5);
    EXPECT_LT((keyframe.T_m_b.p - expected).norm(), 0.03) << keyframe.frame;
  }
}

TEST(Relocalization, IsNotLocatedInTheMapOfAnotherPlace) {
  const KeyframeMap map = map_of(painted_wall(1));
  const cv::Mat other = painted_wall(2);
  std::mt19937_64 random(6);
  for (int start = 0; start < 10; ++start) EXPECT_EQ(second_run(map, other, random).frames, 0);
}

TEST(Relocalization, LoopsOfThisRunAreNoPositionInTheMap) {
  const cv::Mat other = painted_wall(2);
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map_of(painted_wall(1)));
  for (int i = 0; i < 16; ++i) {  // two visits, 9 s apart, between which the odometry drifts by 2 cm
    const bool second = i >= 8;
    const Pose T_w_c{Eigen::Quaterniond::Identity(), {6.0 + 0.15 * (i % 8), 1.5, -2.5}};
    DepartedKeyframe keyframe = keyframe_at(other, T_w_c, i + (second ? 82 : 0));
    keyframe.T_w_b = {T_w_c.q, T_w_c.p + Eigen::Vector3d(second ? 0.02 : 0.0, 0.0, 0.0)};
    const Pose T_m_w = closure.add(keyframe);
    EXPECT_EQ(T_m_w.p, Eigen::Vector3d::Zero()) << i;
  }
  const LoopReport report = closure.finish();
  EXPECT_FALSE(report.relocalized);
  EXPECT_GT(std::ranges::count(report.loops, LoopOutcome::kAccepted, &LoopRecord::outcome), 0);
}

TEST(Relocalization, TheReportContainsTheKeyframesOfThisRunOnly) {
  const cv::Mat wall = painted_wall(1);
  const KeyframeMap map = map_of(wall);
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map);
  for (int i = 0; i < 4; ++i) {
    const Pose T_w_c{Eigen::Quaterniond::Identity(), {6.0 + 0.15 * i, 1.5, -2.5}};
    DepartedKeyframe keyframe = keyframe_at(wall, T_w_c, 100 + i);
    keyframe.T_w_b = T_w_c;
    static_cast<void>(closure.add(keyframe));
  }
  const LoopReport report = closure.finish();
  ASSERT_EQ(report.keyframes.size(), 4U);
  EXPECT_EQ(report.keyframes.front().frame, 100);
  EXPECT_TRUE(report.relocalized);
  for (const LoopRecord& loop : report.loops) EXPECT_TRUE(loop.in_map);
}

TEST(Relocalization, ALocatedRunExtendsTheMap) {
  const cv::Mat wall = painted_wall(1);
  const KeyframeMap map = map_of(wall);
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map);
  const Pose T_o_w{exp_so3({0.0, 0.0, 1.0}), {3.0, 2.0, 1.0}};
  for (int i = 0; i < 4; ++i) {
    const Pose T_w_c{Eigen::Quaterniond::Identity(), {6.0 + 0.15 * i, 1.5, -2.5}};
    DepartedKeyframe keyframe = keyframe_at(wall, T_w_c, i);
    keyframe.T_w_b = T_o_w * T_w_c;
    static_cast<void>(closure.add(keyframe));
  }
  const LoopReport report = closure.finish();
  ASSERT_NE(report.map, nullptr);
  ASSERT_EQ(report.map->keyframes.size(), map.keyframes.size() + 4);
  EXPECT_LT((report.map->keyframes.back().T_w_b.p - Eigen::Vector3d(6.45, 1.5, -2.5)).norm(), 0.03);
  std::mt19937_64 random(8);
  EXPECT_GT(second_run(*report.map, wall, random, Handover::kCurrentFrames).frames, 0);
}

TEST(Relocalization, ARunThatIsNotLocatedDoesNotExtendTheMap) {
  LoopClosure closure({.enabled = true}, kWallCamera, false);
  closure.use_map(map_of(painted_wall(1)));
  DepartedKeyframe keyframe =
      keyframe_at(painted_wall(2), {Eigen::Quaterniond::Identity(), {6.0, 1.5, -2.5}}, 0);
  static_cast<void>(closure.add(keyframe));
  EXPECT_EQ(closure.finish().map, nullptr);
}

}  // namespace
}  // namespace stillpoint
