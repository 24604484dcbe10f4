// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/frame_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/motion/camera_motion.h"
#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/render/mover_tiles.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector3d;

Camera small_camera() {
  return {.width = 160, .height = 120, .fx = 140.0, .fy = 140.0, .cx = 79.5, .cy = 59.5};
}

/// A dark wall at x = 3 that faces the origin, 8 m wide, with one white square of 4 x 4 texels.
struct DotWorld {
  World world;
  Vector3d dot;

  DotWorld() {
    cv::Mat texture_image(256, 256, CV_8UC3, cv::Scalar(40, 40, 40));
    texture_image(cv::Rect(140, 100, 4, 4)).setTo(cv::Scalar(255, 255, 255));
    Builder builder(world);
    const int texture = builder.add_texture(texture_image);
    builder.add_textured_quad({{3.0, 4.0, 4.0}, {0.0, -8.0, 0.0}, {0.0, 0.0, -8.0}}, texture);
    // The center of the white square is at (142, 102) of 256 texels, from the upper left corner.
    dot = {3.0, 4.0 - 8.0 * 142.0 / 256.0, 4.0 - 8.0 * 102.0 / 256.0};
    world.ambient = 1.0F;
    bake_light(world, RayTracer(world), 1);
  }
};

Exposure static_exposure(const Pose& T_w_c) {
  Exposure exposure;
  exposure.poses.emplace_back();
  exposure.poses.front().fill(T_w_c);
  exposure.mid_times = {0.5F};
  return exposure;
}

/// Intensity centroid of the pixels brighter than the wall.
Eigen::Vector2d dot_in(const RenderedFrame& frame) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const double light =
          static_cast<double>(frame.radiance[static_cast<std::size_t>(row * frame.width + column)][1]) - 0.06;
      if (light <= 0.0) continue;
      sum += light * Eigen::Vector2d(column, row);
      weight += light;
    }
  }
  return sum / weight;
}

TEST(FrameRenderer, DepthOfASlantedPlaneIsExact) {
  const DotWorld scene;
  const RayTracer tracer(scene.world);
  const Pose T_w_c{camera_attitude(0.3, 0.1, 0.2), {0.5, 0.2, -0.1}};
  const RenderedFrame frame =
      FrameRenderer(scene.world, tracer, small_camera()).render(static_exposure(T_w_c), nullptr);
  for (const auto& [row, column] : {std::pair{0, 0}, {60, 80}, {119, 159}, {17, 131}}) {
    const Eigen::Vector2d m =
        small_camera().unproject({static_cast<double>(column), static_cast<double>(row)});
    const Vector3d ray = T_w_c.q * Vector3d(m.x(), m.y(), 1.0);
    const double depth = (3.0 - T_w_c.p.x()) / ray.x();  // where the ray meets x = 3
    EXPECT_NEAR(frame.depth_m[static_cast<std::size_t>(row * 160 + column)], depth, 1e-5);
  }
}

TEST(FrameRenderer, WhiteSquareAppearsAtItsProjection) {
  const DotWorld scene;
  const RayTracer tracer(scene.world);
  const FrameRenderer renderer(scene.world, tracer, small_camera());
  for (const Pose& T_w_c : {Pose{camera_attitude(0.0, 0.0, 0.0), Vector3d::Zero()},
                            Pose{camera_attitude(-0.3, -0.1, 0.2), {0.3, 0.4, -0.2}},
                            Pose{camera_attitude(0.2, -0.3, -0.4), {-1.0, -0.3, 0.5}}}) {
    const RenderedFrame frame = renderer.render(static_exposure(T_w_c), nullptr);
    const Eigen::Vector2d expected = small_camera().project(T_w_c.inverse() * scene.dot);
    EXPECT_LT((dot_in(frame) - expected).norm(), 0.2);
  }
}

TEST(FrameRenderer, MotionBlurIsCenteredOnMidExposure) {
  const DotWorld scene;
  const RayTracer tracer(scene.world);
  Exposure exposure = static_exposure({});
  for (int i = 0; i < kLightSamples; ++i) {  // 0.1 rad over the exposure: 14 px
    exposure.poses.front()[static_cast<std::size_t>(i)] =
        Pose{camera_attitude(0.1 * sample_time_offset(i), 0.0, 0.0), Vector3d::Zero()};
  }
  const RenderedFrame frame = FrameRenderer(scene.world, tracer, small_camera()).render(exposure, nullptr);
  const Pose middle{camera_attitude(0.0, 0.0, 0.0), Vector3d::Zero()};
  EXPECT_LT((dot_in(frame) - small_camera().project(middle.inverse() * scene.dot)).norm(), 0.2);
}

/// A ball of 0.2 m at (2, y, 0) that moves 0.1 m to the left (+y) over the exposure.
MoverFrame moving_ball(double y) {
  Actor actor{.object = 7,
              .class_name = "person",
              .parts = {make_limb({0.0, 0.2, 0.2, 1.0}, 0, 1.0, 256)},
              .poses_at = {}};
  actor.poses_at = [y](double t_s) {
    return std::vector<Pose>{{Eigen::Quaterniond::Identity(), {2.0, y + t_s, 0.0}}};
  };
  return assemble_movers(std::span(&actor, 1), -0.05, 0.05);
}

TEST(FrameRenderer, MovingObjectsOccludeTheWorldAndAreLabeled) {
  const DotWorld scene;
  const RayTracer tracer(scene.world);
  const FrameRenderer renderer(scene.world, tracer, small_camera());
  const MoverFrame ball = moving_ball(0.5);
  const Pose T_w_c{camera_attitude(0.0, 0.0, 0.0), Vector3d::Zero()};
  const RenderedFrame frame = renderer.render(static_exposure(T_w_c), &ball);
  const Eigen::Vector2d center = small_camera().project(T_w_c.inverse() * Vector3d(2.0, 0.5, 0.0));
  const auto pixel = static_cast<std::size_t>(std::lround(center.y()) * 160 + std::lround(center.x()));
  EXPECT_EQ(frame.object[pixel], 7);
  EXPECT_NEAR(frame.depth_m[pixel], 1.8, 0.02);  // front of the ball
  // Its true half-width is 0.2 / 2 m * 140 px = 14 px: nothing is labeled 20 px away.
  EXPECT_EQ(frame.object[pixel + 20], 0);
  EXPECT_NEAR(frame.depth_m[pixel + 20], 3.0, 1e-4);
}

/// Boxes that stand beside and behind each other in a hall, with labels on some, under one lamp.
World crowded_world() {
  RandomSequence random(3);
  World world;
  Builder builder(world);
  cv::Mat pattern(64, 64, CV_8UC3);
  for (int i = 0; i < 64 * 64; ++i)
    pattern.at<cv::Vec3b>(i / 64, i % 64) =
        cv::Vec3b::all(static_cast<std::uint8_t>(60 + 40 * (i / 512 % 4)));
  const int texture = builder.add_texture(pattern);
  builder.add_surface({{-2.0, 12.0, 5.0}, {0.0, -24.0, 0.0}, {0.0, 0.0, -10.0}}, texture, 1.0);
  builder.add_surface({{9.0, 12.0, 5.0}, {0.0, -24.0, 0.0}, {0.0, 0.0, -10.0}}, texture, 1.0);
  for (int i = 0; i < 60; ++i) {
    builder.set_frame({random.uniform(2.0, 8.0), random.uniform(-4.0, 4.0), random.uniform(-2.0, 1.0)},
                      random.uniform(0.0, 6.0));
    const double size = random.uniform(0.05, 0.6);
    builder.add_box({0.0, 0.0, 0.0}, {size, 0.5 * size, size}, texture, 0.3);
  }
  world.lamps.push_back({.center = {4.0F, 0.0F, 4.0F}});
  bake_light(world, RayTracer(world), 1);
  return world;
}

// A camera with distortion is rendered by rays.
TEST(FrameRenderer, RendersTheSameByTilesAsByRays) {
  const World world = crowded_world();
  const RayTracer tracer(world);
  Camera traced = small_camera();
  traced.distortion[0] = 1e-12;
  for (const double turn : {-0.5, -0.1, 0.2, 0.6}) {
    Exposure exposure = static_exposure({});
    for (int i = 0; i < kLightSamples; ++i) {
      const double angle = turn + 0.05 * sample_time_offset(i);
      exposure.poses.front()[static_cast<std::size_t>(i)] =
          Pose{camera_attitude(angle, 0.3 * turn, turn), {turn, -turn, 0.2 + 0.1 * turn}};
    }
    exposure.exposure_fraction_of_span = 1.0F;
    const MoverFrame ball = moving_ball(turn);
    const RenderedFrame tiles = FrameRenderer(world, tracer, small_camera()).render(exposure, &ball);
    const RenderedFrame rays = FrameRenderer(world, tracer, traced).render(exposure, &ball);
    int other_depths = 0, other_lights = 0, other_objects = 0, moving = 0;
    for (std::size_t i = 0; i < rays.depth_m.size(); ++i) {
      other_depths += std::abs(tiles.depth_m[i] - rays.depth_m[i]) > 1e-4F * rays.depth_m[i];
      other_lights += std::abs(tiles.radiance[i][1] - rays.radiance[i][1]) > 1e-3F;
      other_objects += tiles.object[i] != rays.object[i];
      moving += rays.object[i] != 0;
    }
    // Rays through edges may hit either side.
    EXPECT_LE(other_depths, 4);
    EXPECT_LE(other_objects, 2);
    EXPECT_LE(other_lights, 20) << "of 19200";
    EXPECT_GT(moving, 20);
  }
}

TEST(FrameRenderer, BuffersOfAnEarlierFrameDoNotShow) {
  const World world = crowded_world();
  const RayTracer tracer(world);
  const FrameRenderer renderer(world, tracer, small_camera());
  const MoverFrame ball = moving_ball(0.2);
  const Pose pose{camera_attitude(0.1, 0.0, 0.0), {0.0, 0.0, 0.2}};
  RenderBuffers buffers;
  renderer.render(static_exposure({}), &ball, buffers);
  const RenderedFrame& again = renderer.render(static_exposure(pose), nullptr, buffers);
  const RenderedFrame alone = renderer.render(static_exposure(pose), nullptr);
  EXPECT_EQ(again.depth_m, alone.depth_m);
  EXPECT_EQ(again.object, alone.object);
  EXPECT_EQ(again.speed_m_per_s, alone.speed_m_per_s);
  EXPECT_TRUE(std::ranges::equal(again.radiance, alone.radiance, [](const Float4& a, const Float4& b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
  }));
}

TEST(MoverTiles, MarksOnlyTilesNearTheMovingObject) {
  const Pose T_w_c{camera_attitude(0.0, 0.0, 0.0), Vector3d::Zero()};
  const MoverFrame ball = moving_ball(0.5);
  const MoverTiles tiles(ball.mesh, small_camera(), std::array{Instant{T_w_c, 0.5F}});
  EXPECT_TRUE(tiles.is_marked(59, 44));  // 79.5 - 0.5 / 2 * 140 = 44.5
  EXPECT_FALSE(tiles.is_marked(59, 140));
  EXPECT_FALSE(tiles.is_marked(59, 44 + 14 + 6));  // the half-width is 0.2 / 2 m * 140 px = 14 px
  const MoverFrame behind = moving_ball(0.0);
  const Pose turned{camera_attitude(3.14159, 0.0, 0.0), Vector3d::Zero()};
  EXPECT_FALSE(MoverTiles(behind.mesh, small_camera(), std::array{Instant{turned, 0.5F}}).is_marked(59, 80));
}

}  // namespace
}  // namespace stillpoint::synth
