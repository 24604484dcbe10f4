// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/klt/klt.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

constexpr int kBorderPx = 8;

void expect_same(const cv::Mat& a, const cv::Mat& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

/// A level including its border.
cv::Mat with_border(cv::Mat level) { return level.adjustROI(kBorderPx, kBorderPx, kBorderPx, kBorderPx); }

TEST(PyramidDownsampling, MatchesOpenCvIncludingBorders) {
  for (const cv::Size size : {cv::Size(160, 120), cv::Size(151, 77)}) {
    cv::Mat expected = random_texture(size, 1);
    ImagePyramid pyramid;
    pyramid.rebuild(expected, kBorderPx, 3, PyramidKind::kImages);
    ASSERT_EQ(pyramid.levels(), 3u);
    for (std::size_t level = 0; level < 3; ++level) {
      cv::Mat bordered;
      cv::copyMakeBorder(expected, bordered, kBorderPx, kBorderPx, kBorderPx, kBorderPx,
                         cv::BORDER_REFLECT_101);
      expect_same(with_border(pyramid.level(level)), bordered);
      cv::pyrDown(cv::Mat(expected), expected);
    }
  }
}

TEST(PyramidDownsampling, RebuildsInPlaceForTheSameSize) {
  ImagePyramid pyramid;
  pyramid.rebuild(random_texture(cv::Size(160, 120), 1), kBorderPx, 3, PyramidKind::kImages);
  const unsigned char* const before = pyramid.level(2).data;
  pyramid.rebuild(random_texture(cv::Size(160, 120), 2), kBorderPx, 3, PyramidKind::kImages);
  EXPECT_EQ(pyramid.level(2).data, before);
  pyramid.rebuild(random_texture(cv::Size(160, 120), 2)(cv::Rect(0, 0, 30, 20)), kBorderPx, 3,
                  PyramidKind::kImages);
  EXPECT_EQ(pyramid.levels(), 2u);  // 8x5 is not larger than the border
}

}  // namespace
}  // namespace stillpoint
