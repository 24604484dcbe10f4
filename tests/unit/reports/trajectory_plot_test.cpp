// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/trajectory_plot.h"

#include <gtest/gtest.h>

namespace stillpoint::report {
namespace {

Trajectory line_along_x(double length_m) {
  Trajectory line;
  for (int i = 0; i <= 10; ++i) {
    StampedPose pose{from_seconds(0.1 * i), {}};
    pose.T_w_f.p = Eigen::Vector3d(0.1 * i * length_m, 0.0, 0.0);
    line.poses.push_back(pose);
  }
  return line;
}

TEST(TrajectoryPlot, ShowsEstimatesThatExceedTheGroundTruth) {
  const Trajectory gt = line_along_x(1.0);
  const Trajectory est = line_along_x(3.0);
  const eval::Evaluation evaluation;  // the identity as alignment
  const Drawing drawing = trajectory_plot(gt, {{.name = "long", .est = &est, .evaluation = &evaluation}});
  double right = 0.0;
  for (const Mark& mark : drawing.marks) {
    if (const auto* line = std::get_if<Polyline>(&mark)) {
      for (const Point2& point : line->points) right = std::max(right, point.x);
    }
  }
  EXPECT_DOUBLE_EQ(right, drawing.width - 60.0);  // the margin
}

}  // namespace
}  // namespace stillpoint::report
