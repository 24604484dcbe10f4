// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/klt/klt.h"

#include <gtest/gtest.h>

#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

constexpr int kWindowPx = 21;
const cv::Size kImageSize(320, 240);

/// Two views of one texture, shifted by `shift_px` to the left.
struct Views {
  ImagePyramid from;
  ImagePyramid to;
};

Views shifted_views(int shift_px, int levels) {
  const cv::Mat texture = random_texture(cv::Size(512, 256), 3);
  Views views;
  views.from.rebuild(texture(cv::Rect({50, 8}, kImageSize)), kWindowPx, levels);
  views.to.rebuild(texture(cv::Rect({50 + shift_px, 8}, kImageSize)), kWindowPx, levels);
  return views;
}

KltResult track(const Views& views, const std::vector<cv::Point2f>& points) {
  return track_points_klt({.from = views.from, .to = views.to, .points = points, .initial_guesses = points},
                          {});
}

const std::vector<cv::Point2f> kPoints = {{100.0F, 60.0F}, {160.0F, 120.0F}, {220.0F, 180.0F}};

TEST(Klt, FindsWholePixelShiftsExactly) {
  const Views views = shifted_views(3, 2);
  const KltResult result = track(views, kPoints);
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    EXPECT_TRUE(result.found[i]);
    EXPECT_LT(cv::norm(result.pixels[i] - (kPoints[i] - cv::Point2f(3.0F, 0.0F))), 0.05);
  }
}

TEST(Klt, AcceptsAnEmptyPointList) {
  const Views views = shifted_views(0, 2);
  EXPECT_TRUE(track(views, {}).pixels.empty());
}

TEST(Klt, RebuildingReusesTheAllocation) {
  ImagePyramid pyramid;
  pyramid.rebuild(random_texture(kImageSize, 1), kWindowPx, 3);
  const unsigned char* const before = pyramid.images().front().data;
  pyramid.rebuild(random_texture(kImageSize, 2), kWindowPx, 3);
  EXPECT_EQ(pyramid.images().front().data, before);
}

}  // namespace
}  // namespace stillpoint
