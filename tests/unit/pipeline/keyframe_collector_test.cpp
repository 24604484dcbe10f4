// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/keyframe_collector.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

/// A window of at most three frames, one step of `step_m` apart, and the frames that enter it.
class KeyframeCollectorTest : public testing::Test {
 protected:
  explicit KeyframeCollectorTest(double step_m = 0.2) : step_m_(step_m) {}

  /// Appends frame `id`; the oldest of more than three leaves the window.
  std::optional<DepartedKeyframe> append(std::int64_t id) {
    WindowFrame frame;
    frame.id = id;
    frame.state.T_w_b.p = {step_m_ * static_cast<double>(id), 0.0, 0.0};
    window_.frames.push_back(frame);
    const bool leaves = window_.frames.size() > 3;
    collector_.before_slide(window_, leaves ? motion_ : std::nullopt);
    if (leaves) window_.frames.erase(window_.frames.begin());
    TrackedFrame tracked{.id = id, .t = from_seconds(static_cast<double>(id))};
    tracked.features = {{.id = 1, .pixel = {10.0, 20.0}, .depth = 1.5}, {.id = 4, .pixel = {30.0, 40.0}}};
    collector_.set_located(located_, segment_);
    collector_.after_slide(window_, tracked, {.labels = {{.id = 4, .label = LabelClass::kDynamicMotion}}});
    return collector_.take();
  }

  double step_m_;
  bool located_ = true;
  int segment_ = 0;
  std::optional<UncertainPose> motion_;  ///< of each step
  Window window_;
  KeyframeCollector collector_{LoopConfig{}};
};

class SlowKeyframeCollectorTest : public KeyframeCollectorTest {
 protected:
  SlowKeyframeCollectorTest() : KeyframeCollectorTest(0.1) {}
};

TEST_F(KeyframeCollectorTest, AFrameIsHandedOverWhenItLeavesTheWindow) {
  for (std::int64_t id = 0; id < 3; ++id) EXPECT_FALSE(append(id));
  window_.frames.front().state.T_w_b.p.x() = 0.01;  // refined until it leaves
  const std::optional<DepartedKeyframe> departed = append(3);
  ASSERT_TRUE(departed);
  EXPECT_EQ(departed->frame, 0);
  EXPECT_EQ(departed->T_w_b.p.x(), 0.01);
  EXPECT_EQ(departed->t, from_seconds(0.0));
}

TEST_F(KeyframeCollectorTest, DynamicFeaturesAreSeparated) {
  std::optional<DepartedKeyframe> departed;
  for (std::int64_t id = 0; id < 4; ++id) departed = append(id);
  ASSERT_TRUE(departed);
  ASSERT_EQ(departed->features.size(), 1u);
  EXPECT_EQ(departed->features.front().pixel, Eigen::Vector2f(10.0F, 20.0F));
  ASSERT_EQ(departed->dynamic_pixels.size(), 1u);
  EXPECT_EQ(departed->dynamic_pixels.front(), Eigen::Vector2f(30.0F, 40.0F));
}

TEST_F(KeyframeCollectorTest, AFrameThatIsRemovedAsNoKeyframeIsDiscarded) {
  append(0);
  append(1);
  window_.frames.erase(window_.frames.begin() + 1);  // the second-newest of the next slide
  for (std::int64_t id = 2; id < 4; ++id) append(id);
  EXPECT_EQ(append(4)->frame, 0);
  EXPECT_EQ(append(5)->frame, 2);
}

TEST_F(SlowKeyframeCollectorTest, FramesCloseToTheLastKeyframeAreDiscarded) {
  std::vector<std::int64_t> departed;
  for (std::int64_t id = 0; id < 8; ++id) {
    if (const auto keyframe = append(id)) departed.push_back(keyframe->frame);
  }
  EXPECT_EQ(departed, (std::vector<std::int64_t>{0, 2, 4}));  // 0.15 m apart at least
}

TEST_F(KeyframeCollectorTest, TheCovarianceOfTheMotionIsUnknownWithoutOneOfTheWindow) {
  for (std::int64_t id = 0; id < 3; ++id) append(id);
  EXPECT_FALSE(append(3)->motion_covariance);
  EXPECT_FALSE(append(4)->motion_covariance);
}

TEST_F(SlowKeyframeCollectorTest, TheCovariancesOfStepsBetweenKeyframesAddUp) {
  // Without rotation, the variance of the position along the motion is that of two steps.
  motion_ = UncertainPose{.T_w_f = {Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}}};
  motion_->covariance(0, 0) = 1e-6;
  std::vector<DepartedKeyframe> departed;
  for (std::int64_t id = 0; id < 8; ++id) {
    if (auto keyframe = append(id)) departed.push_back(std::move(*keyframe));
  }
  ASSERT_EQ(departed.size(), 3u);  // frames 0, 2 and 4
  EXPECT_FALSE(departed[0].motion_covariance);
  for (std::size_t k = 1; k < 3; ++k) {
    ASSERT_TRUE(departed[k].motion_covariance);
    EXPECT_NEAR((*departed[k].motion_covariance)(0, 0), 2e-6, 1e-15);
  }
}

TEST_F(SlowKeyframeCollectorTest, AStepWithoutCovarianceMakesThatOfTheWholeMotionUnknown) {
  motion_ = UncertainPose{};
  std::vector<bool> known;
  for (std::int64_t id = 0; id < 10; ++id) {
    motion_ = id == 4 ? std::nullopt : std::optional(UncertainPose{});  // the step from frame 1 to 2
    if (const auto keyframe = append(id)) known.push_back(keyframe->motion_covariance.has_value());
  }
  EXPECT_EQ(known, (std::vector<bool>{false, false, true, true}));  // frames 0, 2, 4 and 6
}

TEST_F(KeyframeCollectorTest, NothingIsHandedOverWhileThePoseIsLost) {
  located_ = false;
  for (std::int64_t id = 0; id < 6; ++id) EXPECT_FALSE(append(id));
}

TEST_F(KeyframeCollectorTest, TheMotionBetweenSegmentsIsUnknown) {
  motion_ = UncertainPose{};
  for (std::int64_t id = 0; id < 4; ++id) append(id);
  segment_ = 1;
  const std::optional<DepartedKeyframe> first = append(4);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->segment, 1);
  EXPECT_FALSE(first->motion_covariance);
  EXPECT_TRUE(append(5)->motion_covariance);
}

TEST_F(KeyframeCollectorTest, TheNewestFrameIsCopiedAndStaysInTheWindow) {
  append(0);
  append(1);
  const std::optional<DepartedKeyframe> newest = collector_.newest(window_, 1);
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->T_w_b.p.x(), 0.2);
  EXPECT_EQ(newest->features.size(), 1u);
  EXPECT_FALSE(collector_.newest(window_, 0));  // not the newest
  append(2);
  append(3);
  EXPECT_EQ(append(4)->frame, 1);
}

TEST_F(KeyframeCollectorTest, TheRemainingFramesAreHandedOverAtTheEnd) {
  for (std::int64_t id = 0; id < 3; ++id) append(id);
  std::vector<std::int64_t> remaining;
  while (const auto keyframe = collector_.take_remaining(window_)) remaining.push_back(keyframe->frame);
  EXPECT_EQ(remaining, (std::vector<std::int64_t>{0, 1, 2}));
}

TEST_F(KeyframeCollectorTest, TheMotionBetweenRemainingFramesIsUnknown) {
  motion_ = UncertainPose{};
  for (std::int64_t id = 0; id < 5; ++id) append(id);
  std::vector<bool> known;
  while (const auto keyframe = collector_.take_remaining(window_))
    known.push_back(keyframe->motion_covariance.has_value());
  EXPECT_EQ(known, (std::vector<bool>{true, false, false}));  // that to the oldest frame is complete
}

}  // namespace
}  // namespace stillpoint
