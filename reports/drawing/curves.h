// SPDX-License-Identifier: BSD-3-Clause
/// Curves of trajectories for figures: split where poses are missing, and thinned to what can be seen.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/types/trajectory.h"
#include "eval/trajectory/pose_matches.h"
#include "reports/drawing/chart.h"

namespace stillpoint::report {

/// A point of a curve and its time [s].
struct CurvePoint {
  double t_s = 0.0;
  Point2 at;  ///< in units of the axes, y up
};

/// Lines without a gap in them; a pose between two gaps is a line of one point.
using Curve = std::vector<std::vector<CurvePoint>>;

/// Splits where the time between points is more than five times its median, where the value jumps, and at
/// values that are not finite, which are left out.
/// @param points by time
/// @param most_jump of y between neighbors
[[nodiscard]] Curve split_at_gaps(std::span<const CurvePoint> points,
                                  double most_jump = std::numeric_limits<double>::infinity());

/// The points of a line that differ visibly from their neighbors: of consecutive points within a column of
/// 0.3 units, the first, the lowest, the highest and the last, in their order.
[[nodiscard]] std::vector<Point2> thinned(std::span<const Point2> line);

/// Draws the lines of a curve; those of one point as a disc.
void draw_curve(Drawing& drawing, const PlotArea& area, const Curve& curve, const LegendRow& row);

/// The poses of a trajectory after an alignment; times [s] since `start`.
struct TimedPose {
  double t_s = 0.0;
  Pose pose;
};
[[nodiscard]] std::vector<TimedPose> timed_poses(const Trajectory& trajectory, const eval::Similarity& S_w_v,
                                                 Timestamp start, double offset_s = 0.0);

}  // namespace stillpoint::report
