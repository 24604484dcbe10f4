// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/initializer.h"

#include <gtest/gtest.h>

#include "core/imu/imu_buffer.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

/// Exact poses of a motion in a tilted and shifted world, with noise-free inertial samples.
Window exact_window(const Pose& T_visual_w, int frames, double interval_s) {
  const SimulatedMotion motion;
  ImuBuffer buffer;
  for (const ImuSample& sample : motion.imu(3.0)) buffer.add(sample);
  Window window;
  window.T_b_c = SimulatedMotion::rig().T_b_c;
  for (int i = 0; i < frames; ++i) {
    WindowFrame frame;
    frame.state = SimulatedMotion::state(0.5 + interval_s * i);
    frame.state.T_w_b = T_visual_w * frame.state.T_w_b;
    frame.state.v_w.setZero();
    if (i > 0) {
      frame.from_previous.emplace(ImuNoise{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
      frame.from_previous->integrate(buffer.samples_between(window.frames.back().state.t, frame.state.t));
    }
    window.frames.push_back(frame);
  }
  return window;
}

TEST(Initializer, EstimatesGravityAndVelocityInATiltedWorld) {
  const Pose T_visual_w{exp_so3({0.7, -0.3, 0.4}), {1.0, 2.0, 3.0}};
  const Window window = exact_window(T_visual_w, 11, 1.0 / 30.0);
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, {});
  ASSERT_TRUE(alignment);
  // Midpoint integration at 200 Hz is accurate to about 1e-4 of the motion.
  EXPECT_LT((alignment->gravity_w - T_visual_w.q * Eigen::Vector3d(0.0, 0.0, -9.81)).norm(), 0.01);
  EXPECT_LT((alignment->first_velocity_w - T_visual_w.q * SimulatedMotion::state(0.5).v_w).norm(), 0.002);
  EXPECT_LT(alignment->gyro_bias.norm(), 1e-3);
}

TEST(Initializer, AlignsTheWorldWithGravityAndPreservesPositionAndHeading) {
  Window window = exact_window(Pose{exp_so3({0.7, -0.3, 0.4}), {1.0, 2.0, 3.0}}, 11, 1.0 / 30.0);
  const NavState truth = SimulatedMotion::state(0.5);
  apply_alignment(*align_with_imu(window, 9.81, {}), truth.T_w_b, window);
  const NavState& last = window.frames.back().state;
  const NavState truth_last = SimulatedMotion::state(0.5 + 10.0 / 30.0);
  EXPECT_LT(log_so3(truth_last.T_w_b.q.conjugate() * last.T_w_b.q).norm(), 0.002);
  EXPECT_LT((last.T_w_b.p - truth_last.T_w_b.p).norm(), 0.002);
  EXPECT_LT((last.v_w - truth_last.v_w).norm(), 0.005);
}

/// Angle between gravity of the window and `down` [rad].
double tilt(const Window& window, const Eigen::Vector3d& down) {
  return window.gravity_w.normalized().cross(down.normalized()).norm();
}

TEST(Initializer, LevelsAWorldWhoseGravityIsUnknownWithAWeakCovariance) {
  Window window = exact_window(Pose{exp_so3({0.7, -0.3, 0.4}), {1.0, 2.0, 3.0}}, 11, 1.0 / 30.0);
  const NavState truth = SimulatedMotion::state(0.5);
  ASSERT_TRUE(apply_alignment_to_frozen_world(*align_with_imu(window, 9.81, {}), truth.T_w_b, window));
  EXPECT_LT(tilt(window, {0.0, 0.0, -1.0}), 1e-9);
  const NavState& last = window.frames.back().state;
  const NavState truth_last = SimulatedMotion::state(0.5 + 10.0 / 30.0);
  EXPECT_LT(log_so3(truth_last.T_w_b.q.conjugate() * last.T_w_b.q).norm(), 0.002);
  // An accelerometer bias of 0.1 m/s^2 tilts by 0.01 rad; ten times that.
  ASSERT_TRUE(window.estimates_gravity());
  EXPECT_NEAR(std::sqrt((*window.gravity_covariance)(0, 0)), 0.1, 0.02);
  EXPECT_NEAR(std::sqrt((*window.gravity_covariance)(1, 1)), 0.1, 0.02);
}

TEST(Initializer, KeepsAKnownGravityAndTheWorld) {
  const NavState truth = SimulatedMotion::state(0.5);
  Window window = exact_window(Pose{}, 11, 1.0 / 30.0);
  window.gravity_w = exp_so3({0.01, 0.0, 0.0}) * Eigen::Vector3d(0.0, 0.0, -9.81);
  window.gravity_covariance = 1e-6 * Eigen::Matrix2d::Identity();
  const Eigen::Vector3d known = window.gravity_w;
  ASSERT_TRUE(apply_alignment_to_frozen_world(*align_with_imu(window, 9.81, {}), truth.T_w_b, window));
  EXPECT_EQ(window.gravity_w, known);
  EXPECT_EQ((*window.gravity_covariance)(0, 0), 1e-6);
  EXPECT_LT(log_so3(truth.T_w_b.q.conjugate() * window.frames[0].state.T_w_b.q).norm(), 1e-9);
}

TEST(Initializer, ReplacesAKnownGravityThatTheSamplesContradictButKeepsTheWorld) {
  const NavState truth = SimulatedMotion::state(0.5);
  Window window = exact_window(Pose{}, 11, 1.0 / 30.0);
  window.gravity_w = exp_so3({0.3, 0.0, 0.0}) * Eigen::Vector3d(0.0, 0.0, -9.81);
  window.gravity_covariance = 1e-6 * Eigen::Matrix2d::Identity();
  ASSERT_TRUE(apply_alignment_to_frozen_world(*align_with_imu(window, 9.81, {}), truth.T_w_b, window));
  EXPECT_LT(tilt(window, {0.0, 0.0, -1.0}), 0.002);
  EXPECT_GT((*window.gravity_covariance)(0, 0), 1e-3);
  EXPECT_LT(log_so3(truth.T_w_b.q.conjugate() * window.frames[0].state.T_w_b.q).norm(), 1e-9);
}

TEST(Initializer, KeepsAKnownGravityThatPositionsOfAnotherMotionContradict) {
  Window window = exact_window(Pose{}, 11, 1.0 / 30.0);
  // The first frames follow a person who walks with the camera at 0.95 m/s, the others the scene.
  for (int i = 3; i < 11; ++i) {
    window.frames[static_cast<std::size_t>(i)].state.T_w_b.p.x() += 0.95 / 30.0 * (i - 2);
  }
  window.gravity_w = Eigen::Vector3d(0.0, 0.0, -9.81);
  window.gravity_covariance = 1e-4 * Eigen::Matrix2d::Identity();
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, {});
  ASSERT_TRUE(alignment);
  EXPECT_GT(tilt(window, alignment->gravity_w), 0.2);
  EXPECT_GT(alignment->position_sigma, 0.005);
  const Pose first = window.frames[0].state.T_w_b;
  EXPECT_FALSE(apply_alignment_to_frozen_world(*alignment, first, window));
}

TEST(Initializer, RejectsAWindowWithMissingSamples) {
  Window window = exact_window(Pose{}, 6, 0.05);
  window.frames[3].from_previous.reset();
  EXPECT_FALSE(align_with_imu(window, 9.81, {}));
}

TEST(Initializer, RejectsAGravityOfTheWrongNorm) {
  EXPECT_FALSE(align_with_imu(exact_window(Pose{}, 11, 0.05), 3.7, {}));
}

InitializerConfig monocular() {
  InitializerConfig config;
  config.kind = InitializerKind::kMonocular;
  return config;
}

/// The window as reconstructed up to scale: camera positions are divided by `scale`.
Window with_unknown_scale(Window window, double scale) {
  for (int i = 0; i <= window.newest(); ++i) {
    const Pose T_w_c = window.T_w_c(i);
    const Pose shrunk{T_w_c.q, T_w_c.p / scale};
    window.frames[static_cast<std::size_t>(i)].state.T_w_b = shrunk * window.T_b_c.inverse();
  }
  return window;
}

TEST(Initializer, EstimatesTheScaleOfAMonocularWindow) {
  const Pose T_visual_w{exp_so3({0.7, -0.3, 0.4}), Eigen::Vector3d::Zero()};
  const Window window = with_unknown_scale(exact_window(T_visual_w, 11, 0.1), 2.5);
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, monocular());
  ASSERT_TRUE(alignment);
  EXPECT_NEAR(alignment->scale, 2.5, 0.01);
  EXPECT_LT((alignment->gravity_w - T_visual_w.q * Eigen::Vector3d(0.0, 0.0, -9.81)).norm(), 0.02);
}

TEST(Initializer, ScalesAMonocularWindowToMeters) {
  const Window exact = exact_window(Pose{}, 11, 0.1);
  Window window = with_unknown_scale(exact, 2.5);
  window.landmarks.push_back({.observations = {{}, {}}, .inverse_depth = 1.0});
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, monocular());
  ASSERT_TRUE(alignment);
  apply_alignment(*alignment, exact.frames.front().state.T_w_b, window);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    EXPECT_LT((window.frames[i].state.T_w_b.p - exact.frames[i].state.T_w_b.p).norm(), 0.005);
  }
  EXPECT_NEAR(window.landmarks[0].inverse_depth, 1.0 / 2.5, 0.002);
}

TEST(Initializer, RejectsAnUnobservableScale) {
  // Velocity and gravity explain most of the 0.4 m; position errors of 3 cm exceed the rest.
  Window window = with_unknown_scale(exact_window(Pose{}, 11, 0.1), 2.5);
  Random random(4);
  for (WindowFrame& frame : window.frames) {
    frame.state.T_w_b.p += 0.03 / 2.5 * random.normal3();
  }
  InitializerConfig config = monocular();
  config.gravity_tolerance = 9.0;  // so that only the scale can be rejected
  EXPECT_FALSE(align_with_imu(window, 9.81, config));
  config.max_scale_sigma = 10.0;
  EXPECT_TRUE(align_with_imu(window, 9.81, config));
}

}  // namespace
}  // namespace stillpoint
