// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/monocular_structure.h"
#include "core/backend/sliding_window.h"

#include <gtest/gtest.h>

#include "core/backend/window/landmark_tracks.h"
#include "core/imu/imu_buffer.h"
#include "tests/support/published_config.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 11;

BackendConfig monocular() {
  BackendConfig config = published_config().backend;
  config.depth.usage = DepthUsage::kOff;
  config.initializer.kind = InitializerKind::kMonocular;
  return config;
}

std::optional<Window> reconstruct(const Window& window, const BackendConfig& config) {
  return reconstruct_window(window, config, 500.0, *make_window_solver(config.solver));
}

double frame_time(int frame) { return 0.5 + 0.1 * frame; }

/// Tracks and inertial samples, but neither poses nor depths.
Window window_before_initialization(const SimulatedMotion& motion) {
  const Rig rig = SimulatedMotion::rig();
  ImuBuffer buffer;
  for (const ImuSample& sample : motion.imu(2.0)) buffer.add(sample);
  Window window;
  window.T_b_c = rig.T_b_c;
  for (int i = 0; i < kFrames; ++i) {
    WindowFrame frame;
    frame.state.t = from_seconds(frame_time(i));
    if (i > 0) {
      frame.from_previous.emplace(ImuNoise{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
      frame.from_previous->integrate(buffer.samples_between(window.frames.back().state.t, frame.state.t));
    }
    window.frames.push_back(frame);
    add_observations(motion.frame(i, frame_time(i)), rig, monocular().depth, window);
  }
  return window;
}

Pose true_camera(int frame) {
  return SimulatedMotion::state(frame_time(frame)).T_w_b * SimulatedMotion::rig().T_b_c;
}

/// Largest camera position error relative to the true distance between first and newest camera.
double largest_error(const Window& structure) {
  const Pose T_true_new = true_camera(0) * structure.T_w_c(0).inverse();
  const double length = (true_camera(kFrames - 1).p - true_camera(0).p).norm();
  const double scale = length / (structure.T_w_c(kFrames - 1).p - structure.T_w_c(0).p).norm();
  double largest = 0.0;
  for (int i = 1; i < kFrames; ++i) {
    const Eigen::Vector3d displacement = scale * (structure.T_w_c(i).p - structure.T_w_c(0).p);
    largest = std::max(largest, (T_true_new.q * displacement - (true_camera(i).p - true_camera(0).p)).norm());
  }
  return largest / length;
}

TEST(MonocularStructure, ReconstructsExactTracksUpToScale) {
  const std::optional<Window> structure = reconstruct(window_before_initialization({}), monocular());
  ASSERT_TRUE(structure);
  EXPECT_LT(largest_error(*structure), 1e-4);
}

TEST(MonocularStructure, IsRobustToPixelNoise) {
  const std::optional<Window> structure =
      reconstruct(window_before_initialization({.pixel_noise_px = 0.5}), monocular());
  ASSERT_TRUE(structure);
  // 0.5 px at 3 m are 3 mm, averaged over about 100 points; the path is about 0.5 m long.
  EXPECT_LT(largest_error(*structure), 0.02);
}

TEST(MonocularStructure, FailsWithoutParallax) {
  BackendConfig config = monocular();
  config.initializer.min_parallax_px = 200.0;  // 0.5 m at depths of 2-5 m gives 50-125 px
  EXPECT_FALSE(reconstruct(window_before_initialization({}), config));
}

TEST(MonocularStructure, FailsWithoutInertialSamples) {
  Window window = window_before_initialization({});
  window.frames[3].from_previous.reset();
  EXPECT_FALSE(reconstruct(window, monocular()));
}

TEST(MonocularStructure, IgnoresDynamicLandmarks) {
  Window window = window_before_initialization({});
  for (Landmark& landmark : window.landmarks) landmark.dynamic = true;
  EXPECT_FALSE(reconstruct(window, monocular()));
}

}  // namespace
}  // namespace stillpoint
