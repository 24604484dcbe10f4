// SPDX-License-Identifier: BSD-3-Clause
// Presets that return to places: routes, clearance, aliasing and change.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/so3.h"
#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/scene_setup.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/test_data.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep_s = 0.1;
constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kHomeFile = "openloris/groundtruth/gt_home_1.txt";

std::vector<Pose> camera_poses(const SynthRequest& request, const SceneSetup& setup) {
  std::vector<Pose> poses;
  for (double t_s = 0.0; t_s < request.seconds; t_s += kStep_s) {
    poses.push_back(setup.body_path.pose_at(setup.first_frame_s + t_s) * setup.rig.T_b_c);
  }
  return poses;
}

double path_length(const std::vector<Pose>& poses) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) length_m += (poses[i].p - poses[i - 1].p).norm();
  return length_m;
}

/// Seconds of the sequence spent within 1 m and 30 degrees of a pose at least 15 s earlier.
double revisited_s(const std::vector<Pose>& poses) {
  const std::size_t gap = static_cast<std::size_t>(15.0 / kStep_s);
  int revisits = 0;
  for (std::size_t i = gap; i < poses.size(); ++i) {
    revisits += std::any_of(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(i - gap),
                            [&](const Pose& earlier) {
                              return (earlier.p - poses[i].p).norm() < 1.0 &&
                                     log_so3(earlier.q.conjugate() * poses[i].q).norm() < 30.0 * kDegree;
                            });
  }
  return revisits * kStep_s;
}

/// Whether all points within `radius` [m] of the pose are free at some heights between floor and camera.
bool is_clear(const RayTracer& tracer, const Vector3d& camera, double radius) {
  constexpr int kDirections = 24;
  for (const double height : {0.15, 0.45, 0.75, camera.z()}) {
    const Vector3d center(camera.x(), camera.y(), height);
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      const Vector3d rim = center + radius * Vector3d(std::cos(angle), std::sin(angle), 0.0);
      if (!tracer.is_unoccluded(center.cast<float>(), rim.cast<float>())) return false;
    }
  }
  return true;
}

void expect_clear_path(const SceneSetup& setup, const std::vector<Pose>& poses) {
  constexpr double kRobotRadius_m = 0.3;
  const RayTracer before(setup.scene.world);
  const RayTracer after(setup.scene.change ? setup.scene.change->world : setup.scene.world);
  for (const Pose& pose : poses) {
    ASSERT_TRUE(is_clear(before, pose.p, kRobotRadius_m)) << pose.p.transpose();
    ASSERT_TRUE(is_clear(after, pose.p, kRobotRadius_m)) << pose.p.transpose();
  }
}

/// The camera never passes through a person or cart: their centers stay 0.4 m away from it.
void expect_clear_of_actors(const SceneSetup& setup, const std::vector<Pose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double t_s = setup.first_frame_s + kStep_s * static_cast<double>(i);
    for (const Actor& actor : setup.actors) {
      const Vector3d center = actor.poses_at(t_s).front().p;
      ASSERT_GT((center - poses[i].p).head<2>().norm(), 0.4) << actor.class_name << " at " << t_s << " s";
    }
  }
}

/// Speeds of a wheeled robot, with the vibration of 0.07 m/s and 10 degrees/s.
void expect_plausible_motion(const SynthRequest& request, const SceneSetup& setup) {
  for (double t_s = 0.1; t_s < request.seconds; t_s += 0.05) {
    const BodyMotion motion = setup.body_path.at(t_s);
    ASSERT_LT(motion.velocity_w.norm(), 1.3) << t_s;
    ASSERT_LT(motion.rate_b.norm(), 1.5) << t_s;
  }
}

struct ExpectedReturns {
  const char* preset;
  double length_m;     ///< at least
  double revisited_s;  ///< at least
};

class LoopPresets : public testing::TestWithParam<ExpectedReturns> {};

TEST_P(LoopPresets, ReturnsToPlacesWithoutCollisions) {
  SynthRequest request = preset_request(GetParam().preset);
  if (request.preset == "home_tour") {
    const auto file = find_test_data(kHomeFile);
    if (!file) GTEST_SKIP() << missing_test_data(kHomeFile);
    request.trajectory_file = *file;
  }
  const SceneSetup setup = make_scene_setup(request);
  const std::vector<Pose> poses = camera_poses(request, setup);
  RecordProperty("length_m", std::to_string(path_length(poses)));
  EXPECT_GE(path_length(poses), GetParam().length_m);
  EXPECT_GE(revisited_s(poses), GetParam().revisited_s);
  expect_clear_path(setup, poses);
  expect_clear_of_actors(setup, poses);
  expect_plausible_motion(request, setup);
}

// Lengths: office_laps 3 laps of 2 * (6 + 4.8) - (8 - 2 pi) * 0.9 = 20.0 m; corridor_laps a lap of 58 m and a
// third; twin_aisles a lap of 4 * 10.4 + 2 * 7.2 = 56 m less the rounded corners (6 m), and an aisle;
// changed_room a lap of 28 m less 6 m, and half a lap.
INSTANTIATE_TEST_SUITE_P(
    All, LoopPresets,
    testing::Values(ExpectedReturns{"office_laps", 60.0, 45.0}, ExpectedReturns{"corridor_laps", 76.0, 15.0},
                    ExpectedReturns{"market_laps", 150.0, 80.0}, ExpectedReturns{"twin_aisles", 64.0, 10.0},
                    ExpectedReturns{"changed_room", 35.0, 10.0}, ExpectedReturns{"home_tour", 60.0, 60.0},
                    ExpectedReturns{"office_laps_short", 22.0, 2.0},
                    ExpectedReturns{"corridor_laps_short", 60.0, 2.0},
                    ExpectedReturns{"market_laps_short", 54.0, 2.0},
                    ExpectedReturns{"twin_aisles_short", 22.0, 0.0},
                    ExpectedReturns{"changed_room_short", 28.0, 5.0}),
    [](const auto& returns) { return std::string(returns.param.preset); });

/// Quads of the second aisle that equal one of the first.
std::size_t twin_count(const World& world) {
  const auto is_twin = [](const Quad& a, const Quad& b) {
    const Eigen::Vector3f shift(0.0F, static_cast<float>(kTwinShift_m), 0.0F);
    return a.texture == b.texture && a.s == b.s && a.t == b.t && a.edge_u == b.edge_u &&
           a.edge_v == b.edge_v && (a.origin + shift - b.origin).norm() < 1e-4F;
  };
  return static_cast<std::size_t>(std::count_if(world.quads.begin(), world.quads.end(), [&](const Quad& b) {
    return b.origin.y() > 1.0F &&
           std::any_of(world.quads.begin(), world.quads.end(), [&](const Quad& a) { return is_twin(a, b); });
  }));
}

TEST(TwinAisles, HaveEqualShelvesAndGoodsButDifferentSurroundings) {
  const Scene scene = build_twin_aisles(1, 4.0);
  const auto in_second =
      static_cast<std::size_t>(std::count_if(scene.world.quads.begin(), scene.world.quads.end(),
                                             [](const Quad& quad) { return quad.origin.y() > 1.0F; }));
  const std::size_t twins = twin_count(scene.world);
  EXPECT_GT(twins, 1000U);  // goods on 4 half shelves of 4 m in 4 rows
  EXPECT_GT(twins, in_second * 9 / 10);
  EXPECT_LT(twins, in_second - 10);  // signs and posters
}

/// Fraction of quads of the first room that the change moves.
double moved_fraction(const Scene& scene, bool first_room) {
  int moved = 0, all = 0;
  for (std::size_t i = 0; i < scene.world.quads.size(); ++i) {
    const Quad &before = scene.world.quads[i], &after = scene.change->world.quads[i];
    const float x = before.origin.x();
    if (first_room ? x > -0.5F : x < 0.5F) continue;
    ++all;
    moved += (before.origin - after.origin).norm() > 0.2F;
  }
  return static_cast<double>(moved) / all;
}

TEST(ChangedRoom, FurnitureIsMovedAndTheLightIsChangedInTheFirstRoomOnly) {
  const Scene scene = build_changed_room(1);
  ASSERT_EQ(scene.world.quads.size(), scene.change->world.quads.size());
  EXPECT_GT(moved_fraction(scene, true), 0.15);  // most quads are books of shelves that remain
  EXPECT_LT(moved_fraction(scene, true), 0.8);
  EXPECT_EQ(moved_fraction(scene, false), 0.0);
  const Vector3d south(-3.0, -1.8, 1.0);
  const auto light = [&](const World& world) {
    return unshadowed_light(world, south.cast<float>(), Eigen::Vector3f::UnitZ());
  };
  EXPECT_LT(light(scene.change->world), 0.8F * light(scene.world));
}

TEST(ChangedRoom, TheChangeIsNotVisibleWhenItTakesPlace) {
  const SynthRequest request = preset_request("changed_room_short");
  const SceneSetup setup = make_scene_setup(request);
  ASSERT_LT(setup.change_s, request.seconds);
  const Camera camera{.width = 106, .height = 60, .fx = 76.4, .fy = 76.4, .cx = 52.5, .cy = 29.5};
  const auto image_of = [&](const World& world) {
    const RayTracer tracer(world);
    Exposure exposure{.poses = {}, .mid_times = {0.5F}};
    exposure.poses.emplace_back().fill(setup.body_path.pose_at(setup.change_s) * setup.rig.T_b_c);
    return FrameRenderer(world, tracer, camera).render(exposure, nullptr);
  };
  const RenderedFrame before = image_of(setup.scene.world), after = image_of(setup.scene.change->world);
  EXPECT_EQ(before.depth_m, after.depth_m);
  for (std::size_t i = 0; i < before.radiance.size(); ++i) {
    ASSERT_NEAR(before.radiance[i][1], after.radiance[i][1], 0.03F);  // light through the door
  }
}

TEST(HomeTour, RequiresTheGroundTruthOfTheDataSet) {
  SynthRequest request = preset_request("home_tour");
  request.trajectory_file = "/none/gt_home_1.txt";
  expect_input_error([&] { check_request(request); },
                     {"home_tour", "/none/gt_home_1.txt", "STILLPOINT_DATA"});
  expect_input_error([&] { static_cast<void>(request_key(request)); },
                     {"/none/gt_home_1.txt", "STILLPOINT_DATA"});
}

TEST(HomeTour, RejectsAFileWithoutItsSequences) {
  const auto file = find_test_data("openloris/groundtruth/gt_cafe_1.txt");
  if (!file) GTEST_SKIP() << missing_test_data("openloris/groundtruth/gt_cafe_1.txt");
  SynthRequest request = preset_request("home_tour");
  request.trajectory_file = *file;
  expect_input_error([&] { static_cast<void>(make_scene_setup(request)); }, {"sequence 5", "gt_home_1.txt"});
}

}  // namespace
}  // namespace stillpoint::synth
