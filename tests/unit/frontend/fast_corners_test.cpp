// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/fast_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <tuple>

#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

using CornerList = std::vector<std::tuple<float, float, float>>;  // y, x, score

CornerList opencv_corners(const cv::Mat& gray, int threshold) {
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(gray, keypoints, threshold, true);
  CornerList found;
  for (const cv::KeyPoint& keypoint : keypoints) {
    found.emplace_back(keypoint.pt.y, keypoint.pt.x, keypoint.response);
  }
  std::sort(found.begin(), found.end());
  return found;
}

CornerList our_corners(FastCorners& fast, const cv::Mat& gray, int threshold) {
  CornerList found;
  for (const Corner& corner : fast.find(gray, threshold)) {
    found.emplace_back(corner.pixel.y, corner.pixel.x, corner.score);
  }
  return found;
}

cv::Mat noise(const cv::Size& size) {
  cv::Mat gray(size, CV_8UC1);
  cv::RNG random(7);
  random.fill(gray, cv::RNG::UNIFORM, 0, 256);
  return gray;
}

TEST(FastCorners, MatchOpenCvInPositionsAndScores) {
  FastCorners fast;
  for (const cv::Mat& gray : {random_texture(cv::Size(211, 97), 1), noise(cv::Size(64, 48))}) {
    for (const int threshold : {1, 10, 60}) {
      const CornerList found = our_corners(fast, gray, threshold);
      EXPECT_GT(found.size(), 3u);
      EXPECT_EQ(found, opencv_corners(gray, threshold));
    }
  }
}

TEST(FastCorners, MatchOpenCvOnImagesNarrowerThanARegister) {
  FastCorners fast;
  const cv::Mat whole = noise(cv::Size(64, 48));
  const cv::Mat gray = whole(cv::Rect(5, 4, 20, 30));
  EXPECT_EQ(our_corners(fast, gray, 10), opencv_corners(gray, 10));
  EXPECT_TRUE(fast.find(whole(cv::Rect(0, 0, 6, 40)), 10).empty());
  EXPECT_TRUE(fast.find(whole(cv::Rect(0, 0, 40, 6)), 10).empty());
}

}  // namespace
}  // namespace stillpoint
