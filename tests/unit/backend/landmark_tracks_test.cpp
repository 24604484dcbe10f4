// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/landmark_tracks.h"

#include <gtest/gtest.h>

#include "tests/support/window_world.h"

namespace stillpoint {
namespace {

TEST(LandmarkTracks, KeepTheirPlaceWhenTheOldestFrameGoes) {
  Window window = visual_window(5, 10);
  const Eigen::Vector3d before = window.position(window.landmarks[3]);
  remove_oldest_frame(window);
  ASSERT_EQ(window.frames.size(), 4u);
  EXPECT_EQ(window.landmarks[3].host, 0);
  EXPECT_EQ(window.landmarks[3].observations.size(), 4u);
  EXPECT_LT((window.position(window.landmarks[3]) - before).norm(), 1e-9);
}

TEST(LandmarkTracks, LoseOneObservationWhenTheSecondNewestFrameGoes) {
  Window window = visual_window(5, 10);
  const Eigen::Vector2d newest = window.landmarks[0].observations.back().bearing;
  remove_second_newest_frame(window);
  EXPECT_EQ(window.landmarks[0].last(), 3);
  EXPECT_EQ(window.landmarks[0].in(3).bearing, newest);
}

TEST(LandmarkTracks, MoveToTheNewestFrameWhenTheirHostGoes) {
  Window window = visual_window(5, 1);
  Landmark& landmark = window.landmarks[0];
  landmark.host = 3;  // seen by frames 3 and 4 only
  landmark.observations = {landmark.observations[3], landmark.observations[4]};
  landmark.inverse_depth = 1.0 / landmark.observations[0].depth;
  const double depth_in_newest = landmark.observations[1].depth;
  remove_second_newest_frame(window);
  ASSERT_EQ(window.landmarks.size(), 1u);
  EXPECT_EQ(window.landmarks[0].host, 3);
  EXPECT_NEAR(1.0 / window.landmarks[0].inverse_depth, depth_in_newest, 1e-9);
}

TEST(LandmarkTracks, BeginAnewWhenTheirPastIsForgotten) {
  Window window = visual_window(5, 1);
  Landmark& landmark = window.landmarks[0];
  const Eigen::Vector2d newest = landmark.observations.back().bearing;
  forget_past(landmark);
  EXPECT_EQ(landmark.host, 4);
  ASSERT_EQ(landmark.observations.size(), 1u);
  EXPECT_EQ(landmark.observations[0].bearing, newest);
  EXPECT_EQ(landmark.inverse_depth, 0.0);
}

TEST(LandmarkTracks, JoinByIdAndStartWhereTheTrackerFoundThem) {
  Window window = visual_window(3, 2);
  window.frames.push_back(window.frames.back());
  TrackedFrame frame;
  frame.features = {{.id = 1, .depth = 2.0}, {.id = 7, .depth = 0.1}};
  add_observations(frame, Rig{.camera = {.height = 480}}, DepthConfig{}, window);
  ASSERT_EQ(window.landmarks.size(), 3u);
  EXPECT_EQ(window.landmarks[1].observations.size(), 4u);
  EXPECT_EQ(window.landmarks[2].host, 3);
  EXPECT_EQ(window.landmarks[2].observations[0].depth, 0.0);  // nearer than min_m: not believed
}

/// A camera at rest: frames 0.1 s apart that see the same `landmarks` at the same places.
Window resting_window(int landmarks) {
  Window window = visual_window(4, landmarks);
  for (Landmark& landmark : window.landmarks) {
    for (Observation& seen : landmark.observations) seen = landmark.observations[0];
  }
  return window;
}

TEST(LandmarkTracks, AStillCameraMakesNoKeyframe) {
  const Window window = resting_window(30);
  EXPECT_FALSE(is_second_newest_keyframe(window, {}, 500.0));
  EXPECT_TRUE(
      is_second_newest_keyframe(window, {.keyframe_max_interval_s = 0.15}, 500.0));  // 0.2 s have passed
}

TEST(LandmarkTracks, AStillCameraMakesAKeyframeForTheNewLandmarks) {
  const BackendConfig config{.keyframe_min_tracked = 0, .keyframe_min_shared = 0.5};
  Window window = resting_window(30);
  const auto let_newest_find = [&](int count) {  // not seen by frame 1, the last keyframe
    for (int i = 0; i < count; ++i) {
      Landmark& landmark = window.landmarks[static_cast<std::size_t>(i)];
      landmark.host = 2;
      landmark.observations.resize(2);
    }
  };
  let_newest_find(15);  // half of them new: 15 of 30 shared
  EXPECT_FALSE(is_second_newest_keyframe(window, config, 500.0));
  let_newest_find(16);
  EXPECT_TRUE(is_second_newest_keyframe(window, config, 500.0));
}

TEST(LandmarkTracks, AMovingThingNeitherMakesNorSparesAKeyframe) {
  const BackendConfig config{.keyframe_min_tracked = 20};
  Window window = resting_window(30);
  for (std::size_t i = 0; i < 10; ++i) {  // on a person: 100 px a frame
    window.landmarks[i].dynamic = true;
    for (std::size_t k = 0; k < 4; ++k)
      window.landmarks[i].observations[k].bearing.x() += 0.2 * static_cast<double>(k);
  }
  EXPECT_FALSE(is_second_newest_keyframe(window, config, 500.0));  // 20 others stand still
  window.landmarks[10].dynamic = true;
  EXPECT_TRUE(is_second_newest_keyframe(window, config, 500.0));  // 19 are too few to hold on to
}

}  // namespace
}  // namespace stillpoint
