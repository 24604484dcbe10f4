// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/view_recovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include <opencv2/core.hpp>

#include "core/frontend/feature_tracker.h"
#include "core/geometry/so3.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

constexpr double kDistance_m = 2.0;
constexpr int kFramesBefore = 6;
constexpr int kBlankFrames = 80;
constexpr int kByChance = 10;  ///< features that the point tracker finds in another view

/// 45 px, 3 degrees and 5 % closer.
const Pose kMotion{exp_so3({0.0, 0.0, 0.05}), {0.18, -0.05, -0.1}};

/// A tracker that saw a plane for some frames.
class ViewLoss : public testing::Test {
 protected:
  ViewLoss() : plane_(test_camera(), kDistance_m, 7), tracker_(config(), test_camera()) {
    for (int i = 0; i < kFramesBefore - 1; ++i) static_cast<void>(see(Pose{}));
    for (const TrackedFeature& feature : see(Pose{}).features) lost_[feature.id] = feature;
  }
  static FrontendConfig config() {
    FrontendConfig config;
    config.tracker = TrackerKind::kPatch;
    config.min_correlation = 0.85;
    config.recover_view = true;
    config.depth_max_spread = 0.0;
    return config;
  }
  TrackedFrame track(const cv::Mat& gray) {
    Frame frame = plane_.frame_at(Pose{}, id_++);
    frame.gray = gray;
    return tracker_.track(frame, {}, {});
  }
  TrackedFrame see(const Pose& T_c_first) { return track(plane_.gray_at(T_c_first)); }
  TrackedFrame see_nothing() {
    return track(cv::Mat::zeros(test_camera().height, test_camera().width, CV_8UC1));
  }
  TrackedFrame see_another() { return track(another_); }

  [[nodiscard]] int continued(const TrackedFrame& frame) const {
    return static_cast<int>(std::ranges::count_if(
        frame.features, [&](const TrackedFeature& feature) { return lost_.contains(feature.id); }));
  }
  /// Of the lost features that a frame contains: how many are where the motion moves them to.
  [[nodiscard]] int correct(const TrackedFrame& frame, const Pose& T_c_first) const {
    return static_cast<int>(std::ranges::count_if(frame.features, [&](const TrackedFeature& feature) {
      const auto before = lost_.find(feature.id);
      return before != lost_.end() &&
             (plane_.pixel_in(T_c_first, before->second.pixel) - feature.pixel).norm() < 1.0;
    }));
  }

  const TexturedPlane plane_;
  const cv::Mat another_ = TexturedPlane(test_camera(), kDistance_m, 8).gray_at(Pose{});
  FeatureTracker tracker_;
  std::map<std::int64_t, TrackedFeature> lost_;
  std::int64_t id_ = 0;
};

TEST_F(ViewLoss, TracksContinueAfterBlankImages) {
  ASSERT_GE(lost_.size(), 60U);
  for (int i = 0; i < kBlankFrames; ++i) EXPECT_EQ(continued(see_nothing()), 0);
  const TrackedFrame returned = see(kMotion);
  EXPECT_GE(correct(returned, kMotion), 40);
  EXPECT_EQ(correct(returned, kMotion), continued(returned));
  EXPECT_TRUE(std::ranges::is_sorted(returned.features, {}, &TrackedFeature::id));
  EXPECT_GE(continued(see(kMotion)), 40);
}

/// Without a prediction, patches that look alike are mistaken for each other.
TEST_F(ViewLoss, TracksContinueAfterAJump) {
  const TrackedFrame jumped = see(kMotion);
  EXPECT_GE(correct(jumped, kMotion), 40);
  EXPECT_EQ(correct(jumped, kMotion), continued(jumped));
}

TEST_F(ViewLoss, AnotherViewHasFewOfTheTracks) { EXPECT_LT(continued(see_another()), kByChance); }

TEST_F(ViewLoss, ViewIsForgottenWhileAnotherIsSeen) {
  for (int i = 0; i < 70; ++i) static_cast<void>(see_another());
  EXPECT_LT(continued(see(Pose{})), kByChance);
}

TEST(ViewRecovery, IsOffByDefault) { EXPECT_FALSE(FrontendConfig{}.recover_view); }

TEST_F(ViewLoss, ResetForgetsTheView) {
  tracker_.reset();
  EXPECT_EQ(continued(see(Pose{})), 0);
}

}  // namespace
}  // namespace stillpoint
