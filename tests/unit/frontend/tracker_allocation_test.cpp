// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <utility>

#include "bench/profile/allocation_counter.h"
#include "core/frontend/feature_tracker.h"
#include "tests/unit/frontend/textured_picture.h"

namespace stillpoint {
namespace {

/// Pictures on the way to and fro along a textured plane; features leave and are found anew.
std::vector<Frame> frames_to_and_fro() {
  const TexturedPlane plane(test_camera(), 2.0, 1);
  std::vector<Frame> frames;
  for (const int step : {0, 1, 2, 3, 4, 3, 2, 1}) {
    const Pose T_c_first{Eigen::Quaterniond::Identity(), {-0.05 * step, 0.01 * step, 0.0}};
    frames.push_back(
        {.gray = plane.gray_at(T_c_first), .depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(2000))});
  }
  return frames;
}

FrontendConfig fast_config() {
  FrontendConfig config;
  config.tracker = TrackerKind::kPatch;
  config.outlier_model = OutlierModel::kRigid;
  config.grid.stop_early = true;
  return config;
}

TEST(FeatureTracker, AllocatesNothingOnceItHasSeenAsMuch) {
  const std::vector<Frame> frames = frames_to_and_fro();
  FeatureTracker tracker(fast_config(), test_camera());
  TrackedFrame tracked;
  std::int64_t picture = 0;
  const auto round = [&] {
    int detected = 0;
    for (Frame frame : frames) {
      frame.id = picture++;
      frame.t = Timestamp{33'000'000 * frame.id};
      tracked = tracker.track(frame, {}, true, {}, std::move(tracked));
      detected += tracked.detected;
    }
    return detected;
  };
  const std::size_t before = allocation_count();
  for (int i = 0; i < 4; ++i) static_cast<void>(round());
  const std::size_t between = allocation_count();
  EXPECT_GT(round(), 0);  // there was work to do
  EXPECT_EQ(allocation_count(), between);
  EXPECT_GT(between, before);  // the counter counts
  EXPECT_GT(tracked.features.size(), 50u);
}

}  // namespace
}  // namespace stillpoint
