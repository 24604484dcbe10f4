// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/trajectory_plot.h"

#include <gtest/gtest.h>

#include "eval/io/nmea_file.h"

namespace stillpoint::report {
namespace {

Trajectory line_to_north(const std::string& frame) {
  Trajectory path;
  path.frame = frame;
  for (int i = 0; i <= 10; ++i) {
    StampedPose pose;
    pose.t = from_seconds(i);
    pose.T_w_f.p = {0.0, 10.0 * i, 0.0};
    path.poses.push_back(pose);
  }
  return path;
}

TEST(LocalMap, HasARoundScaleBar) {
  EXPECT_DOUBLE_EQ(scale_bar_m(100.0), 20.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(160.0), 50.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(4.0), 1.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(0.5), 0.1);
}

TEST(LocalMap, DrawsNorthUpToScale) {
  const Drawing drawing = local_map(line_to_north(eval::kGnssFrame), {});
  const auto& path = std::get<Polyline>(drawing.marks.front());
  EXPECT_LT(path.points.back().y, path.points.front().y);
  EXPECT_DOUBLE_EQ(path.points.back().x, path.points.front().x);
  // 100 m fill the width of 660 units; the bar of 20 m has a fifth of it.
  EXPECT_NEAR(path.points.front().y - path.points.back().y, 660.0, 1e-9);
  EXPECT_NE(svg_text(drawing).find(">N<"), std::string::npos);
  EXPECT_NE(svg_text(drawing).find("20 m"), std::string::npos);
}

TEST(LocalMap, NamesTheAxisWithoutGnss) {
  EXPECT_EQ(svg_text(local_map(line_to_north("camera"), {})).find(">N<"), std::string::npos);
  EXPECT_TRUE(local_map({}, {}).marks.empty());
}

}  // namespace
}  // namespace stillpoint::report
