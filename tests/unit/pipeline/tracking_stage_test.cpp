// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/tracking_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "tests/support/published_config.h"
#include "tests/support/simulated/sliding_plane.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMoving = 3;   ///< frames before the image freezes
constexpr std::size_t kFrozen = 20;  ///< repetitions
constexpr double kRate = 6.0;        ///< of the camera, in turn to the left and to the right [rad/s]

std::vector<std::int64_t> ids_of(const TrackedFrame& frame) {
  std::vector<std::int64_t> ids;
  for (const TrackedFeature& feature : frame.features) ids.push_back(feature.id);
  return ids;
}

bool is_frozen(std::size_t frame) { return frame >= kMoving && frame < kMoving + kFrozen; }

/// Inertial data of one second, in which the camera turns while the image is frozen.
void add_turns(TrackingStage& stage) {
  for (int i = 0; i < 1000; ++i) {
    const double t = 1.0 + 0.001 * i;
    const auto frame = static_cast<std::size_t>((t - 1.0) * 30.0);
    const double rate = !is_frozen(frame) ? 0.0 : frame % 2 == 0 ? kRate : -kRate;
    stage.add_imu({.t = from_seconds(t), .gyro_b = {0.0, rate, 0.0}, .accel_b = {0.0, 0.0, 9.8}});
  }
}

/// The camera turns left and right while it delivers the same image. In half of the frames the prediction of
/// the tracker differs from that image by 30 px.
TEST(TrackingStage, KeepsItsFeaturesWhileTheImageIsFrozen) {
  const SlidingPlane plane(kMoving + kFrozen + 2);
  const SensorInput input = plane.input();
  OdometryConfig config = published_config();
  config.imu.enabled = true;
  config.frontend.min_distance_px = 15;
  config.frontend.prediction = TrackerPrediction::kFull;
  TrackingStage stage(config, input.rig);
  add_turns(stage);
  Feedback feedback;
  feedback.motion.initialized = true;
  feedback.motion.uses_imu = true;
  std::vector<std::int64_t> before;
  for (std::size_t i = 0; i < kMoving + kFrozen + 1; ++i) {
    const std::size_t shown = i < kMoving ? i : is_frozen(i) ? kMoving - 1 : kMoving;
    Frame frame = plane.frame(shown);
    frame.id = static_cast<std::int64_t>(i);
    frame.t = input.frame_times[i];
    feedback.motion.newest.t = input.frame_times[i];
    const TrackedFrame tracked = stage.process(frame, true, feedback);
    EXPECT_EQ(tracked.id, frame.id);
    if (is_frozen(i)) {
      EXPECT_TRUE(tracked.features.empty()) << i;
      continue;
    }
    const std::vector<std::int64_t> ids = ids_of(tracked);
    std::vector<std::int64_t> kept;
    std::ranges::set_intersection(ids, before, std::back_inserter(kept));
    if (i > 0) {
      EXPECT_GE(kept.size(), before.size() / 2) << i;
    }
    before = ids;
  }
  EXPECT_GE(before.size(), 8U);
}

}  // namespace
}  // namespace stillpoint
