// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/actors/movers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/synthetic/motion/camera_motion.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;

const std::vector<Vector2d> kSquare{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {0.0, 4.0}};

TEST(ClosedRoute, HasRoundedCornersAndIsClosed) {
  const ClosedRoute route(kSquare, 0.5);
  // Each of four corners replaces 2 * 0.5 m by a quarter circle of 0.5 m: 16 - 4 + pi = 15.14 m.
  EXPECT_NEAR(route.length_m(), 12.0 + std::numbers::pi, 0.01);
  EXPECT_LT((route.at(1.0).position - route.at(1.0 + route.length_m()).position).norm(), 1e-9);
  EXPECT_NEAR(route.at(1.0 + route.length_m()).heading - route.at(1.0).heading, 2.0 * std::numbers::pi, 1e-9);
}

TEST(ClosedRoute, PositionAndHeadingAreContinuous) {
  const ClosedRoute route(kSquare, 0.5);
  for (double distance = -3.0; distance < 20.0; distance += 0.01) {
    const auto here = route.at(distance), next = route.at(distance + 0.01);
    EXPECT_LE((next.position - here.position).norm(), 0.0101);
    EXPECT_LT(std::abs(next.heading - here.heading),
              0.05);  // 0.01 m / 0.5 m = 0.02 rad, smoothed over segments
  }
}

TEST(Walk, KeepsClearOfAStaticCamera) {
  const Vector2d camera(4.0, 2.0);  // on the route
  const Walk walk(ClosedRoute(kSquare, 0.5), {.speed = 1.0, .camera_clearance_m = 1.0},
                  {[&](double) { return camera; }, 0.0, 60.0}, 3);
  for (double t_s = 0.0; t_s < 60.0; t_s += 0.1) EXPECT_GT((walk.at(t_s).position - camera).norm(), 0.5);
}

TEST(Walk, AlternatesBetweenStoppingAndWalking) {
  const Walk walk(ClosedRoute(kSquare, 0.5), {.speed = 1.0, .stops_per_minute = 10.0},
                  {[](double) { return Vector2d(99.0, 99.0); }, 0.0, 60.0}, 3);
  int still = 0, moving = 0;
  for (double t_s = 0.0; t_s < 60.0; t_s += 0.1) ++(walk.at(t_s).pace < 0.05 ? still : moving);
  EXPECT_GT(still, 30);
  EXPECT_GT(moving, 200);
}

TEST(Person, WalksUprightWithFeetOnTheFloor) {
  World world;
  Builder builder(world);
  const Walk walk(ClosedRoute(kSquare, 0.5), {.speed = 1.0},
                  {[](double) { return Vector2d(99.0, 99.0); }, 0.0, 10.0}, 3);
  const Actor walker = make_walking_person(builder, 1, walk, 4);
  for (double t_s = 0.5; t_s < 9.0; t_s += 0.37) {
    const MoverFrame frame = assemble_movers(std::span(&walker, 1), t_s, t_s + 0.01);
    float lowest = 9.0F, highest = -9.0F;
    for (const Eigen::Vector3f& point : frame.mesh.start) {
      lowest = std::min(lowest, point.z());
      highest = std::max(highest, point.z());
      EXPECT_LT((point.head<2>().cast<double>() - walk.at(t_s).position).norm(), 1.0);
    }
    EXPECT_NEAR(lowest, 0.0F, 0.08F);
    EXPECT_GT(highest, 1.5F);
    EXPECT_LT(highest, 2.0F);
  }
}

TEST(RobotPath, KeepsTheConfiguredSpeedAndLimitsTheTurnRate) {
  const RobotRoute route{{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}, {0.0, 10.0}}, 1.0, 0.7, 0.6, 1.1};
  const PathSpline path = robot_path(route, {Pose{}, 1, 0.0, 40.0});
  double fastest_turn = 0.0;
  for (double t_s = 0.5; t_s < 40.0; t_s += 0.05) {
    const BodyMotion motion = path.at(t_s);
    EXPECT_LT(motion.velocity_w.norm(), 0.78);  // 0.7 m/s plus 0.07 m/s of vibration
    EXPECT_NEAR(motion.T_w_b.p.z(), 1.1, 0.002);
    fastest_turn = std::max(fastest_turn, motion.rate_b.norm());
  }
  EXPECT_GT(fastest_turn, 0.4);  // reaches a corner (11 m after 16 s)
  EXPECT_LT(fastest_turn, 1.0);
  EXPECT_NEAR((path.pose_at(5.0).p - path.pose_at(2.0).p).norm(), 2.1, 0.02);
}

}  // namespace
}  // namespace stillpoint::synth
