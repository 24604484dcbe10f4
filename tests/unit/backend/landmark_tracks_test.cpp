// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window/landmark_tracks.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

TEST(LandmarkTracks, KeepTheirPositionWhenTheOldestFrameIsRemoved) {
  Window window = visual_window(5, 10);
  const Eigen::Vector3d before = window.position(window.landmarks[3]);
  remove_oldest_frame(window);
  ASSERT_EQ(window.frames.size(), 4u);
  EXPECT_EQ(window.landmarks[3].host, 0);
  EXPECT_EQ(window.landmarks[3].observations.size(), 4u);
  EXPECT_LT((window.position(window.landmarks[3]) - before).norm(), 1e-9);
}

TEST(LandmarkTracks, LoseOneObservationWhenTheSecondNewestFrameIsRemoved) {
  Window window = visual_window(5, 10);
  const Eigen::Vector2d newest = window.landmarks[0].observations.back().bearing;
  remove_second_newest_frame(window);
  EXPECT_EQ(window.landmarks[0].last(), 3);
  EXPECT_EQ(window.landmarks[0].observation_in(3).bearing, newest);
}

TEST(LandmarkTracks, AreHostedInTheNewestFrameWhenTheirHostIsRemoved) {
  Window window = visual_window(5, 1);
  Landmark& landmark = window.landmarks[0];
  landmark.host = 3;  // observed in frames 3 and 4 only
  landmark.observations = {landmark.observations[3], landmark.observations[4]};
  landmark.inverse_depth = 1.0 / landmark.observations[0].depth;
  const double depth_in_newest = landmark.observations[1].depth;
  remove_second_newest_frame(window);
  ASSERT_EQ(window.landmarks.size(), 1u);
  EXPECT_EQ(window.landmarks[0].host, 3);
  EXPECT_NEAR(1.0 / window.landmarks[0].inverse_depth, depth_in_newest, 1e-9);
}

TEST(LandmarkTracks, KeepOnlyTheNewestObservationAfterARestart) {
  Window window = visual_window(5, 1);
  Landmark& landmark = window.landmarks[0];
  const Eigen::Vector2d newest = landmark.observations.back().bearing;
  restart_track(landmark);
  EXPECT_EQ(landmark.host, 4);
  ASSERT_EQ(landmark.observations.size(), 1u);
  EXPECT_EQ(landmark.observations[0].bearing, newest);
  EXPECT_EQ(landmark.inverse_depth, 0.0);
}

/// With bearings of the lens before, a restart without it moved the camera by 0.5 m.
TEST(LandmarkTracks, OfTheNewestFrameHaveTheLensOfTheirWindow) {
  Window window = visual_window(5, 1);
  const Eigen::Vector2d seen = window.landmarks[0].observations.back().bearing;
  window.landmarks[0].observations.back().seen = seen;
  set_lens({0.1, 0.0, 0.0, 0.0}, window);
  ASSERT_EQ(landmarks_of_newest(window, window.lens)[0].observations[0].bearing, 1.1 * seen);
  EXPECT_EQ(landmarks_of_newest(window, Eigen::Vector4d::Zero())[0].observations[0].bearing, seen);
}

TEST(LandmarkTracks, IgnoreABearingThatIsNotFinite) {
  Window window = visual_window(4, 1);
  TrackedFrame frame;
  frame.features = {{.id = 7, .bearing = {std::numeric_limits<double>::quiet_NaN(), 0.2}}};
  add_observations(frame, Rig{.camera = {.height = 480}}, DepthConfig{}, window);
  EXPECT_EQ(window.landmarks.size(), 1u);
}

TEST(LandmarkTracks, BeginAnewWhenTheyAreRecognizedAfterALoss) {
  Window window = visual_window(4, 1);
  Landmark& landmark = window.landmarks[0];
  landmark.observations.resize(2);  // lost in frame 2
  TrackedFrame frame;
  frame.features = {{.id = 0, .bearing = {0.1, 0.2}, .depth = 2.0}};
  add_observations(frame, Rig{.camera = {.height = 480}}, DepthConfig{}, window);
  ASSERT_EQ(window.landmarks.size(), 1u);
  EXPECT_EQ(window.landmarks[0].host, 3);
  ASSERT_EQ(window.landmarks[0].observations.size(), 1u);
  EXPECT_EQ(window.landmarks[0].observations[0].bearing, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(window.landmarks[0].inverse_depth, 0.0);
}

TEST(LandmarkTracks, EndOneFrameEarlierWhenTheNewestFrameIsRemoved) {
  Window window = visual_window(4, 2);
  window.landmarks[1].host = 3;
  window.landmarks[1].observations.resize(1);
  remove_newest_frame(window);
  EXPECT_EQ(window.frames.size(), 3u);
  ASSERT_EQ(window.landmarks.size(), 1u);
  EXPECT_EQ(window.landmarks[0].last(), 2);
}

TEST(LandmarkTracks, AreExtendedByIdAndNewOnesAreHostedInTheNewestFrame) {
  Window window = visual_window(3, 2);
  window.frames.push_back(window.frames.back());
  TrackedFrame frame;
  frame.features = {{.id = 1, .depth = 2.0}, {.id = 7, .depth = 0.1}};
  add_observations(frame, Rig{.camera = {.height = 480}}, DepthConfig{}, window);
  ASSERT_EQ(window.landmarks.size(), 3u);
  EXPECT_EQ(window.landmarks[1].observations.size(), 4u);
  EXPECT_EQ(window.landmarks[2].host, 3);
  EXPECT_EQ(window.landmarks[2].observations[0].depth, 0.0);  // below min_m: ignored
}

/// The tracker knows no velocity of a new feature, so the first row of a rolling shutter was not corrected.
TEST(LandmarkTracks, HaveTheVelocityOfTheSecondObservationInTheFirst) {
  for (const TimeOffsetModel model : {TimeOffsetModel::kInertial, TimeOffsetModel::kBearing}) {
    Window window = visual_window(3, 0);
    window.time_offset_model = model;
    const Rig rig{.camera = {.height = 480}};
    TrackedFrame frame;
    frame.features = {{.id = 5, .depth = 2.0}};
    add_observations(frame, rig, DepthConfig{}, window);
    for (const double velocity : {0.3, 0.4}) {
      window.frames.push_back(window.frames.back());
      frame.features[0].velocity.x() = velocity;
      add_observations(frame, rig, DepthConfig{}, window);
    }
    ASSERT_EQ(window.landmarks[0].observations.size(), 3u);
    const double first = model == TimeOffsetModel::kInertial ? 0.3 : 0.0;  // kBearing: as published
    EXPECT_EQ(window.landmarks[0].observations[0].velocity.x(), first);
    EXPECT_EQ(window.landmarks[0].observations[1].velocity.x(), 0.3);
    EXPECT_EQ(window.landmarks[0].observations[2].velocity.x(), 0.4);
  }
}

/// A static camera: frames 0.1 s apart with identical observations of `landmarks` landmarks.
Window static_camera_window(int landmarks) {
  Window window = visual_window(4, landmarks);
  for (Landmark& landmark : window.landmarks) {
    for (Observation& observation : landmark.observations) observation = landmark.observations[0];
  }
  return window;
}

TEST(LandmarkTracks, AStaticCameraTriggersNoKeyframe) {
  const Window window = static_camera_window(30);
  EXPECT_FALSE(is_second_newest_keyframe(window, {}, 500.0));
  EXPECT_TRUE(
      is_second_newest_keyframe(window, {.keyframe_max_interval_s = 0.15}, 500.0));  // 0.2 s have passed
}

TEST(LandmarkTracks, NewLandmarksTriggerAKeyframeOfAStaticCamera) {
  const BackendConfig config{.keyframe_min_shared_ratio = 0.5, .keyframe_min_tracked = 0};
  Window window = static_camera_window(30);
  const auto hide_from_last_keyframe = [&](int count) {  // not observed in frame 1, the last keyframe
    for (int i = 0; i < count; ++i) {
      Landmark& landmark = window.landmarks[static_cast<std::size_t>(i)];
      landmark.host = 2;
      landmark.observations.resize(2);
    }
  };
  hide_from_last_keyframe(15);  // half of them new: 15 of 30 shared
  EXPECT_FALSE(is_second_newest_keyframe(window, config, 500.0));
  hide_from_last_keyframe(16);
  EXPECT_TRUE(is_second_newest_keyframe(window, config, 500.0));
}

TEST(LandmarkTracks, DynamicLandmarksDoNotAffectTheKeyframeDecision) {
  const BackendConfig config{.keyframe_min_tracked = 20};
  Window window = static_camera_window(30);
  for (std::size_t i = 0; i < 10; ++i) {  // on a person: 100 px per frame
    window.landmarks[i].dynamic = true;
    for (std::size_t k = 0; k < 4; ++k)
      window.landmarks[i].observations[k].bearing.x() += 0.2 * static_cast<double>(k);
  }
  EXPECT_FALSE(is_second_newest_keyframe(window, config, 500.0));  // 20 static ones
  window.landmarks[10].dynamic = true;
  EXPECT_TRUE(is_second_newest_keyframe(window, config, 500.0));  // 19 are too few
}

}  // namespace
}  // namespace stillpoint
