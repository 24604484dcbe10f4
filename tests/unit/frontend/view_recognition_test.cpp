// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/view_recognition.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <opencv2/core.hpp>

#include "tests/support/simulated/sliding_plane.h"

namespace stillpoint {
namespace {

constexpr int kFirst_px = 40;
constexpr int kSpacing_px = 9;
constexpr int kPerRow = 9;
constexpr int kCount = 36;

/// Features on a grid of the plane, which is `shift_px` further left than in the first image.
TrackedFrame grid_frame(std::int64_t first_id, int age, int shift_px) {
  TrackedFrame frame;
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector2d pixel(kFirst_px + kSpacing_px * (i % kPerRow) - shift_px,
                                kFirst_px + kSpacing_px * (i / kPerRow));
    frame.features.push_back({.id = first_id + i, .pixel = pixel, .age = age});
  }
  return frame;
}

TEST(ViewRecognition, GivesLostFeaturesTheirIdsBack) {
  const SlidingPlane plane(4);
  ViewRecognition recognition;
  static_cast<void>(recognition.process(plane.frame(0).gray, grid_frame(0, 3, 0)));
  const cv::Mat blank(120, 160, CV_8UC1, cv::Scalar(0));
  EXPECT_TRUE(recognition.process(blank, {}).features.empty());
  const TrackedFrame returned =
      recognition.process(plane.frame(2).gray, grid_frame(100, 1, 2 * SlidingPlane::kStep_px));
  int recognized = 0;
  for (const TrackedFeature& feature : returned.features) {
    if (feature.id >= 100) continue;
    ++recognized;
    const Eigen::Vector2d expected = grid_frame(0, 1, 4).features[static_cast<std::size_t>(feature.id)].pixel;
    EXPECT_EQ(feature.pixel, expected);
  }
  EXPECT_GE(recognized, 12);
  const TrackedFrame next = recognition.process(plane.frame(3).gray, grid_frame(100, 2, 6));
  EXPECT_TRUE(std::ranges::is_sorted(next.features, {}, &TrackedFeature::id));
  EXPECT_EQ(next.features.front().id, returned.features.front().id);
  const std::vector<std::int64_t> ids{next.features.front().id};
  EXPECT_EQ(recognition.tracker_ids(ids, {}), std::vector<std::int64_t>{ids.front() + 100});
}

TEST(ViewRecognition, LeavesContinuedTracksUnchanged) {
  const SlidingPlane plane(2);
  ViewRecognition recognition;
  static_cast<void>(recognition.process(plane.frame(0).gray, grid_frame(0, 3, 0)));
  const TrackedFrame next = recognition.process(plane.frame(1).gray, grid_frame(0, 4, 2));
  EXPECT_EQ(next.features.back().id, kCount - 1);
}

TEST(ViewRecognition, DoesNotRecognizeAnotherView) {
  const SlidingPlane plane(1);
  ViewRecognition recognition;
  static_cast<void>(recognition.process(plane.frame(0).gray, grid_frame(0, 3, 0)));
  cv::Mat other;
  cv::flip(plane.frame(0).gray, other, -1);
  const TrackedFrame returned = recognition.process(other, grid_frame(100, 1, 0));
  EXPECT_EQ(returned.features.front().id, 100);
}

}  // namespace
}  // namespace stillpoint
