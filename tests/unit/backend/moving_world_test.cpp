// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/moving_world.h"

#include <random>

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr double kWorldFocal_px = 500.0;
constexpr int kWorldFrames = 8;           // at 10 Hz
constexpr double kWorldSpeed_m_s = 0.75;  // of the camera, along x

struct MovingScene {
  double believed_m_s = 0.0;  ///< speed of the camera by the states of the window
  double extent_m = 4.0;      ///< of the points, in each direction
  double nearest_m = 1.0;
  bool dynamic = true;
};

/// A window whose newest frame is at `seconds`.
Window window_of(const MovingScene& scene, double seconds) {
  Window window;
  for (int i = 0; i < kWorldFrames; ++i) {
    WindowFrame frame;
    const double t = seconds + 0.1 * (i + 1 - kWorldFrames);
    frame.state.t = after(Timestamp{1'000'000'000}, t);
    frame.state.T_w_b.p.x() = scene.believed_m_s * t;
    window.frames.push_back(frame);
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector3d p{scene.extent_m * part(random), scene.extent_m * part(random),
                            scene.nearest_m + scene.extent_m * (0.5 + part(random))};
    Landmark landmark{.id = k, .dynamic = scene.dynamic};
    for (int i = 0; i < kWorldFrames; ++i) {
      const Eigen::Vector3d p_c = p - Eigen::Vector3d(0.1 * kWorldSpeed_m_s * i, 0.0, 0.0);
      landmark.observations.push_back({.bearing = p_c.hnormalized(), .depth = p_c.z()});
    }
    window.landmarks.push_back(landmark);
  }
  return window;
}

/// Time after which the world has appeared to move for long enough; nothing within 3 s.
std::optional<double> recognized_after(const MovingScene& scene) {
  MovingWorld world(kWorldFocal_px);
  for (int i = 0; i <= 30; ++i) {
    if (world.update(window_of(scene, 0.1 * i))) return 0.1 * i;
  }
  return std::nullopt;
}

TEST(MovingWorld, IsRecognizedWhereARoomMovesThatTheWindowTakesForDynamic) {
  const std::optional<double> seconds = recognized_after({});
  ASSERT_TRUE(seconds);
  EXPECT_NEAR(*seconds, 1.5, 0.01);
}

TEST(MovingWorld, IsNotAPersonBeforeTheCamera) {
  EXPECT_FALSE(recognized_after({.extent_m = 0.6, .nearest_m = 0.5}));
}

TEST(MovingWorld, IsNotOneThatAgreesWithTheWindow) {
  EXPECT_FALSE(recognized_after({.believed_m_s = kWorldSpeed_m_s}));
}

/// Features that are not labeled yet may follow an error that the next optimization corrects.
TEST(MovingWorld, HasDynamicFeatures) { EXPECT_FALSE(recognized_after({.dynamic = false})); }

TEST(MovingWorld, IsNotRecognizedIfTheWindowAgreesInBetween) {
  MovingWorld world(kWorldFocal_px);
  for (int i = 0; i <= 30; ++i) {
    const MovingScene scene{.believed_m_s = i % 10 == 9 ? kWorldSpeed_m_s : 0.0};
    EXPECT_FALSE(world.update(window_of(scene, 0.1 * i))) << i;
  }
}

}  // namespace
}  // namespace stillpoint
