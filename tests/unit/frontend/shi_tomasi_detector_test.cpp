// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/feature_detector.h"

#include <gtest/gtest.h>

#include "core/frontend/detect/grid_detector.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

TEST(ShiTomasiDetector, DetectsTheWantedNumberOnFreePixelsAtMinimumDistance) {
  const cv::Mat gray = random_texture(cv::Size(320, 240), 1);
  FeatureMask mask;
  mask.clear(gray.size());
  mask.occupy_circle({160.0F, 120.0F}, 60);
  ShiTomasiDetector detector;
  const std::vector<cv::Point2f> corners =
      detector.detect({.gray = gray, .mask = mask, .tracked = {}, .wanted = 20, .min_distance_px = 15});
  ASSERT_EQ(corners.size(), 20U);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_TRUE(mask.is_free(corners[i]));
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(cv::norm(corners[i] - corners[j]), 15.0);
  }
}

TEST(ShiTomasiDetector, DetectsNothingWithoutTextureOrRequest) {
  const cv::Mat blank(240, 320, CV_8UC1, cv::Scalar(100));
  FeatureMask mask;
  mask.clear(blank.size());
  ShiTomasiDetector detector;
  EXPECT_TRUE(detector.detect({.gray = blank, .mask = mask, .tracked = {}, .wanted = 20}).empty());
  const cv::Mat gray = random_texture(blank.size(), 1);
  EXPECT_TRUE(detector.detect({.gray = gray, .mask = mask, .tracked = {}, .wanted = 0}).empty());
}

TEST(FeatureDetector, IsSelectedByTheConfig) {
  FrontendConfig config;
  EXPECT_NE(dynamic_cast<GridDetector*>(make_feature_detector(config).get()), nullptr);
  config.detector = FeatureDetectorKind::kShiTomasi;
  EXPECT_NE(dynamic_cast<ShiTomasiDetector*>(make_feature_detector(config).get()), nullptr);
}

}  // namespace
}  // namespace stillpoint
