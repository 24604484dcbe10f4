// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/surface_samples.h"

#include <gtest/gtest.h>

#include "tests/support/fake_frame_report.h"

namespace stillpoint::report {
namespace {

const Camera kSurfaceCamera{.width = 160, .height = 120, .fx = 120.0, .fy = 120.0, .cx = 79.5, .cy = 59.5};

/// A frame of a camera at (1, 0, 0) that sees a gray wall at z = 2 m, and an object at 1 m.
void add_wall(SurfaceSamples& samples, double t_s, OdometryStatus status = OdometryStatus::kTracking,
              int segment = 0) {
  FakeFrameReport fake(0);
  fake.frame.t = from_seconds(t_s);
  fake.frame.gray.setTo(90);
  fake.frame.depth.setTo(2000);
  fake.frame.depth(cv::Rect(40, 32, 40, 56)).setTo(1000);
  fake.update.status = status;
  fake.update.segment = segment;
  fake.update.T_w_c.p.x() = 1.0;
  fake.dynamic.labels.push_back({.id = 1, .label = LabelClass::kStable});
  const std::vector<Box> boxes{{.x_min = 38, .y_min = 30, .x_max = 82, .y_max = 90}};
  fake.dynamic.mask =
      SemanticMask(boxes, {fake.frame.depth, 1000.0}, fake.frame.gray.size(),
                   DynamicConfig{.mask = DynamicMask::kDepthThreshold, .epsilon_m = 0.5, .box_margin_px = 0});
  samples.add(fake.report());
}

TEST(SurfaceSamples, AreTheStaticPixelsOfLocatedFramesOfTheFirstWorld) {
  SurfaceSamples samples(kSurfaceCamera);
  add_wall(samples, 0.0);
  add_wall(samples, 0.1);  // too early
  add_wall(samples, 0.6, OdometryStatus::kLost);
  add_wall(samples, 1.2, OdometryStatus::kTracking, 1);
  EXPECT_EQ(samples.ply(), "") << "of a single frame";
  add_wall(samples, 1.8);
  const std::vector<eval::CloudPoint> cloud = eval::parse_ply(samples.ply(), "surfaces");
  ASSERT_GT(cloud.size(), 500U);
  float least_x = 10.0F;
  for (const eval::CloudPoint& point : cloud) {
    EXPECT_NEAR(point.p.z(), 2.0F, 1e-5F) << "without the object";
    EXPECT_EQ(point.rgb, (std::array<std::uint8_t, 3>{90, 90, 90}));
    least_x = std::min(least_x, point.p.x());
  }
  EXPECT_NEAR(least_x, 1.0F - 2.0F * 78.5F / 120.0F, 0.04F);
}

}  // namespace
}  // namespace stillpoint::report
