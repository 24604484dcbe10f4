// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/initializer.h"

#include <gtest/gtest.h>

#include "core/imu/imu_buffer.h"
#include "tests/support/simulated_flight.h"

namespace stillpoint {
namespace {

/// Exact poses of a flight in a world that is neither level nor at the origin, with noise-free samples
/// between them.
Window exact_window(const Pose& T_visual_w, int frames, double interval_s) {
  const SimulatedFlight flight;
  ImuBuffer buffer;
  for (const ImuSample& sample : flight.imu(3.0)) buffer.add(sample);
  Window window;
  window.T_b_c = SimulatedFlight::rig().T_b_c;
  for (int i = 0; i < frames; ++i) {
    WindowFrame frame;
    frame.state = SimulatedFlight::state(0.5 + interval_s * i);
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

TEST(Initializer, FindsGravityAndSpeedInATiltedWorld) {
  const Pose T_visual_w{exp_so3({0.7, -0.3, 0.4}), {1.0, 2.0, 3.0}};
  const Window window = exact_window(T_visual_w, 11, 1.0 / 30.0);
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, {});
  ASSERT_TRUE(alignment);
  // Midpoint integration at 200 Hz is good to about 1e-4 of the motion.
  EXPECT_LT((alignment->gravity_w - T_visual_w.q * Eigen::Vector3d(0.0, 0.0, -9.81)).norm(), 0.01);
  EXPECT_LT((alignment->first_velocity_w - T_visual_w.q * SimulatedFlight::state(0.5).v_w).norm(), 0.002);
  EXPECT_LT(alignment->gyro_bias.norm(), 1e-3);
}

TEST(Initializer, MakesTheWorldLevelAndKeepsPlaceAndHeading) {
  Window window = exact_window(Pose{exp_so3({0.7, -0.3, 0.4}), {1.0, 2.0, 3.0}}, 11, 1.0 / 30.0);
  const NavState truth = SimulatedFlight::state(0.5);
  make_inertial(*align_with_imu(window, 9.81, {}), truth.T_w_b, window);
  const NavState& last = window.frames.back().state;
  const NavState truth_last = SimulatedFlight::state(0.5 + 10.0 / 30.0);
  EXPECT_LT(log_so3(truth_last.T_w_b.q.conjugate() * last.T_w_b.q).norm(), 0.002);
  EXPECT_LT((last.T_w_b.p - truth_last.T_w_b.p).norm(), 0.002);
  EXPECT_LT((last.v_w - truth_last.v_w).norm(), 0.005);
}

TEST(Initializer, RefusesAWindowWithoutSamples) {
  Window window = exact_window(Pose{}, 6, 0.05);
  window.frames[3].from_previous.reset();
  EXPECT_FALSE(align_with_imu(window, 9.81, {}));
}

TEST(Initializer, RefusesAWorldWithTheWrongGravity) {
  EXPECT_FALSE(align_with_imu(exact_window(Pose{}, 11, 0.05), 3.7, {}));
}

InitializerConfig monocular() {
  InitializerConfig config;
  config.kind = InitializerKind::kMonocular;
  return config;
}

/// The window as structure from motion leaves it: a metre of the camera's path is `1 / metres` long.
Window of_unknown_scale(Window window, double metres) {
  for (int i = 0; i <= window.newest(); ++i) {
    const Pose T_w_c = window.T_w_c(i);
    const Pose shrunk{T_w_c.q, T_w_c.p / metres};
    window.frames[static_cast<std::size_t>(i)].state.T_w_b = shrunk * window.T_b_c.inverse();
  }
  return window;
}

TEST(Initializer, FindsTheScaleOfAMonocularWindow) {
  const Pose T_visual_w{exp_so3({0.7, -0.3, 0.4}), Eigen::Vector3d::Zero()};
  const Window window = of_unknown_scale(exact_window(T_visual_w, 11, 0.1), 2.5);
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, monocular());
  ASSERT_TRUE(alignment);
  EXPECT_NEAR(alignment->scale, 2.5, 0.01);
  EXPECT_LT((alignment->gravity_w - T_visual_w.q * Eigen::Vector3d(0.0, 0.0, -9.81)).norm(), 0.02);
}

TEST(Initializer, MakesAMonocularWindowMetric) {
  const Window exact = exact_window(Pose{}, 11, 0.1);
  Window window = of_unknown_scale(exact, 2.5);
  window.landmarks.push_back({.observations = {{}, {}}, .inverse_depth = 1.0});
  const std::optional<InertialAlignment> alignment = align_with_imu(window, 9.81, monocular());
  ASSERT_TRUE(alignment);
  make_inertial(*alignment, exact.frames.front().state.T_w_b, window);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    EXPECT_LT((window.frames[i].state.T_w_b.p - exact.frames[i].state.T_w_b.p).norm(), 0.005);
  }
  EXPECT_NEAR(window.landmarks[0].inverse_depth, 1.0 / 2.5, 0.002);
}

TEST(Initializer, RefusesAScaleThatTheMotionDoesNotShow) {
  // Speed and gravity take most of the camera's 0.4 m; of the few cm left, errors of 3 cm hide the scale.
  Window window = of_unknown_scale(exact_window(Pose{}, 11, 0.1), 2.5);
  Random random(4);
  for (WindowFrame& frame : window.frames) {
    frame.state.T_w_b.p += 0.03 / 2.5 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  }
  InitializerConfig config = monocular();
  config.gravity_tolerance = 9.0;  // so that it is the scale that is refused
  EXPECT_FALSE(align_with_imu(window, 9.81, config));
  config.max_scale_sigma = 10.0;
  EXPECT_TRUE(align_with_imu(window, 9.81, config));
}

}  // namespace
}  // namespace stillpoint
