// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/keyframe.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/loop/loop_verification.h"

namespace stillpoint {
namespace {

const Camera kCamera{.width = 320, .height = 320, .fx = 300.0, .fy = 300.0, .cx = 159.5, .cy = 159.5};

/// Rectangles of random gray values at a depth of 2 m.
DepartedKeyframe textured_keyframe() {
  DepartedKeyframe keyframe;
  keyframe.gray = cv::Mat(kCamera.height, kCamera.width, CV_8UC1);
  cv::RNG random(1);
  for (int i = 0; i < 400; ++i) {
    const int height = random.uniform(10, 60), width = random.uniform(10, 60);
    const int y = random.uniform(-20, 320), x = random.uniform(-20, 320);
    cv::rectangle(keyframe.gray, cv::Rect(x, y, width, height), random.uniform(0, 256), cv::FILLED);
  }
  keyframe.depth = cv::Mat(kCamera.height, kCamera.width, CV_16UC1, cv::Scalar(2000));
  return keyframe;
}

Eigen::Vector2d pixel_of(const KeyframeFeature& feature) {
  return kCamera.project(feature.p_c.cast<double>());
}

TEST(KeyframeFeatures, HaveTheMeasuredDepth) {
  const std::vector<KeyframeFeature> features = keyframe_features(textured_keyframe(), kCamera, {});
  EXPECT_GT(features.size(), 150u);
  for (const KeyframeFeature& feature : features) EXPECT_NEAR(feature.p_c.z(), 2.0F, 1e-5F);
}

TEST(KeyframeFeatures, IncludeTheTrackedFeatures) {
  DepartedKeyframe keyframe = textured_keyframe();
  keyframe.features = {{7, {100.5F, 90.25F}, 1.5F}, {8, {50.0F, 60.0F}, 0.0F}};
  const std::vector<KeyframeFeature> features = keyframe_features(keyframe, kCamera, {.max_corners = 0});
  ASSERT_EQ(features.size(), 1u) << "one has no depth";
  EXPECT_LT((pixel_of(features.front()) - Eigen::Vector2d(100.5, 90.25)).norm(), 1e-4);
  EXPECT_EQ(features.front().track, 7);
}

TEST(KeyframeFeatures, AreNotOnPeopleOrAtDynamicFeatures) {
  DepartedKeyframe keyframe = textured_keyframe();
  keyframe.regions = {
      {.box = {.x_min = 100.0, .y_min = 0.0, .x_max = 200.0, .y_max = 320.0}, .near_m = 1.0, .far_m = 3.0}};
  keyframe.dynamic_pixels = {{250.0F, 150.0F}};
  const auto is_excluded = [](const KeyframeFeature& feature) {
    const Eigen::Vector2d pixel = pixel_of(feature);
    return (pixel.x() >= 100.0 && pixel.x() <= 200.0) ||
           (pixel - Eigen::Vector2d(250.0, 150.0)).norm() < 20.0;
  };
  EXPECT_EQ(std::ranges::count_if(keyframe_features(keyframe, kCamera, {}), is_excluded), 0);
  EXPECT_GT(
      std::ranges::count_if(keyframe_features(keyframe, kCamera, {.exclude_dynamic = false}), is_excluded),
      30);
}

TEST(KeyframeFeatures, BehindAMaskedPersonAreKept) {
  DepartedKeyframe keyframe = textured_keyframe();
  keyframe.regions = {
      {.box = {.x_min = 0.0, .y_min = 0.0, .x_max = 320.0, .y_max = 320.0}, .near_m = 0.5, .far_m = 1.5}};
  EXPECT_GT(keyframe_features(keyframe, kCamera, {}).size(), 150u);
}

TEST(KeyframeFeatures, DescriptorsDoNotDependOnTheRollOfTheCamera) {
  DepartedKeyframe upright = textured_keyframe();
  DepartedKeyframe rolled = upright;
  rolled.gray = cv::Mat();  // a copy of cv::Mat shares its pixels
  cv::rotate(upright.gray, rolled.gray, cv::ROTATE_90_CLOCKWISE);
  upright.gravity_b = Eigen::Vector3d(0.0, 1.0, 0.0);  // down in the image
  rolled.gravity_b = Eigen::Vector3d(-1.0, 0.0, 0.0);
  const auto before = keyframe_features(upright, kCamera, {});
  const auto after = keyframe_features(rolled, kCamera, {});
  const std::vector<FeatureMatch> matches = match_features(after, before);
  const auto correct = std::ranges::count_if(matches, [&](const FeatureMatch& match) {
    const Eigen::Vector3f p = before[static_cast<std::size_t>(match.match)].p_c;
    return (after[static_cast<std::size_t>(match.query)].p_c - Eigen::Vector3f(-p.y(), p.x(), p.z())).norm() <
           0.03F;
  });
  EXPECT_GT(matches.size(), before.size() / 2);
  EXPECT_GT(correct, 0.9 * static_cast<double>(matches.size()));
}

}  // namespace
}  // namespace stillpoint
