// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <utility>

#include "bench/profile/meters/allocation_counter.h"
#include "core/frontend/feature_tracker.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

/// Frames of a back-and-forth motion along a textured plane; features leave the image and are redetected.
std::vector<Frame> ping_pong_frames() {
  const TexturedPlane plane(test_camera(), 2.0, 1);
  std::vector<Frame> frames;
  for (const int step : {0, 1, 2, 3, 4, 3, 2, 1}) {
    const Pose T_c_first{Eigen::Quaterniond::Identity(), {-0.05 * step, 0.01 * step, 0.0}};
    frames.push_back(
        {.gray = plane.gray_at(T_c_first), .depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(2000))});
  }
  return frames;
}

TEST(FeatureTracker, SteadyStateIsAllocationFree) {
  const std::vector<Frame> frames = ping_pong_frames();
  FeatureTracker tracker(FrontendConfig{}, test_camera());
  TrackedFrame tracked;
  std::int64_t frame_id = 0;
  const auto round = [&] {
    int detected = 0;
    for (Frame frame : frames) {
      frame.id = frame_id++;
      frame.t = Timestamp{33'000'000 * frame.id};
      tracked = tracker.track(frame, {}, {}, std::move(tracked));
      detected += tracked.detected;
    }
    return detected;
  };
  const std::size_t before = bench::allocation_count();
  for (int i = 0; i < 4; ++i) static_cast<void>(round());
  const std::size_t between = bench::allocation_count();
  EXPECT_GT(round(), 0);  // features were detected
  EXPECT_EQ(bench::allocation_count(), between);
  EXPECT_GT(between, before);  // the counter counts
  EXPECT_GT(tracked.features.size(), 50u);
}

}  // namespace
}  // namespace stillpoint
