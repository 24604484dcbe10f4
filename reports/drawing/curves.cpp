// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/curves.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "eval/metrics/statistics.h"

namespace stillpoint::report {

Curve split_at_gaps(std::span<const CurvePoint> points, double most_jump) {
  constexpr double kGapRatio = 5.0;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < points.size(); ++i) intervals.push_back(points[i].t_s - points[i - 1].t_s);
  const double most_s = kGapRatio * eval::percentile(intervals, 0.5).value_or(0.0);
  Curve curve;
  bool is_open = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].at.y)) {
      is_open = false;
      continue;
    }
    is_open = is_open && points[i].t_s - points[i - 1].t_s <= most_s &&
              std::abs(points[i].at.y - points[i - 1].at.y) <= most_jump;
    if (!is_open) curve.emplace_back();
    is_open = true;
    curve.back().push_back(points[i]);
  }
  return curve;
}

std::vector<Point2> thinned(std::span<const Point2> line) {
  constexpr double kColumn = 0.3;
  const auto column_of = [](const Point2& point) { return std::floor(point.x / kColumn); };
  std::vector<Point2> kept;
  for (std::size_t begin = 0; begin < line.size();) {
    std::size_t end = begin + 1;
    while (end < line.size() && column_of(line[end]) == column_of(line[begin])) ++end;
    const auto part = line.subspan(begin, end - begin);
    const auto [low, high] = std::ranges::minmax_element(part, {}, &Point2::y);
    std::array<std::size_t, 4> chosen{0, static_cast<std::size_t>(low - part.begin()),
                                      static_cast<std::size_t>(high - part.begin()), part.size() - 1};
    std::ranges::sort(chosen);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (k == 0 || chosen[k] != chosen[k - 1]) kept.push_back(part[chosen[k]]);
    }
    begin = end;
  }
  return kept;
}

void draw_curve(Drawing& drawing, const PlotArea& area, const Curve& curve, const LegendRow& row) {
  for (const std::vector<CurvePoint>& line : curve) {
    std::vector<Point2> points;
    points.reserve(line.size());
    for (const CurvePoint& point : line) points.push_back(area.at(point.at.x, point.at.y));
    if (points.size() == 1) {
      drawing.marks.push_back(Disc{points.front(), 0.7 * row.width, row.style.color});
    } else {
      drawing.marks.push_back(styled_line(thinned(points), row.style, row.width));
    }
  }
}

std::vector<TimedPose> timed_poses(const Trajectory& trajectory, const eval::Similarity& S_w_v,
                                   Timestamp start, double offset_s) {
  std::vector<TimedPose> poses;
  poses.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses)
    poses.push_back({seconds_between(start, pose.t) + offset_s, S_w_v * pose.T_w_f});
  return poses;
}

}  // namespace stillpoint::report
