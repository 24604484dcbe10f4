// SPDX-License-Identifier: BSD-3-Clause
// Plan views of trajectories.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "eval/io/nmea_file.h"
#include "reports/drawing/curves.h"
#include "reports/drawing/figures.h"

namespace stillpoint::report {
namespace {

/// Indices of the coordinates to the right, up, and of the side view.
using ViewAxes = std::array<int, 3>;

struct PathView {
  std::vector<TimedPose> truth;
  std::vector<std::vector<TimedPose>> estimates;
  bool is_gnss = false;
};

PathView view_of(const FigureInput& input) {
  const Timestamp start = input.gt.poses.front().t;
  PathView view{.truth = timed_poses(input.gt, {}, start), .estimates = {}};
  view.is_gnss = input.gt.frame == eval::kGnssFrame;
  for (const PlottedRun& run : input.runs)
    view.estimates.push_back(timed_poses(*run.est, run.evaluation->alignment.S_w_v, start, input.offset_s));
  return view;
}

ValueRange extent(const std::vector<TimedPose>& poses, int axis) {
  ValueRange range;
  for (const TimedPose& timed : poses) range.add(timed.pose.p(axis));
  return range;
}

ValueRange extent(const PathView& view, int axis) {
  ValueRange range = extent(view.truth, axis);
  for (const std::vector<TimedPose>& estimate : view.estimates) {
    const ValueRange own = extent(estimate, axis);
    range.add(own.low);
    range.add(own.high);
  }
  return padded(range, 0.05);
}

/// The plane in which the ground truth is longest, in the order of the alphabet.
ViewAxes longest_axes(const PathView& view) {
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(
      order, [&](int a, int b) { return extent(view.truth, a).length() > extent(view.truth, b).length(); });
  return {std::min(order[0], order[1]), std::max(order[0], order[1]), order[2]};
}

std::string axis_title(const PathView& view, int axis) {
  constexpr std::array<const char*, 3> kNames{"x [m]", "y [m]", "z [m]"};
  constexpr std::array<const char*, 3> kGnssNames{"east [m]", "north [m]", "up [m]"};
  return view.is_gnss ? kGnssNames[static_cast<std::size_t>(axis)] : kNames[static_cast<std::size_t>(axis)];
}

Curve curve_of(const std::vector<TimedPose>& poses, int right, int up) {
  std::vector<CurvePoint> points;
  points.reserve(poses.size());
  for (const TimedPose& timed : poses) points.push_back({timed.t_s, {timed.pose.p(right), timed.pose.p(up)}});
  return split_at_gaps(points);
}

/// The positions of a run that have an error, and these errors, split at gaps.
struct ColoredPath {
  Curve lines;  ///< y and x of the view
  std::vector<std::vector<double>> errors;
  double most = 0.0;
};

ColoredPath colored_path(const FigureInput& input, const std::vector<TimedPose>& poses, int right, int up) {
  constexpr double kSameTime_s = 1e-6;
  ColoredPath path;
  std::vector<CurvePoint> points;
  std::vector<double> errors;
  auto pose = poses.begin();
  for (const CurvePoint& error : error_points(input, input.runs.front())) {
    while (pose != poses.end() && pose->t_s < error.t_s - kSameTime_s) ++pose;
    if (pose == poses.end()) break;
    points.push_back({error.t_s, {pose->pose.p(right), pose->pose.p(up)}});
    errors.push_back(error.at.y);
    path.most = std::max(path.most, error.at.y);
  }
  path.lines = split_at_gaps(points);
  auto next = errors.begin();
  for (const std::vector<CurvePoint>& line : path.lines) {
    path.errors.emplace_back(next, next + static_cast<std::ptrdiff_t>(line.size()));
    next += static_cast<std::ptrdiff_t>(line.size());
  }
  return path;
}

/// Places at least 1 unit apart on a line, each with the mean error since the one before.
struct ColoredPoints {
  std::vector<Point2> at;
  std::vector<double> errors;
};

ColoredPoints visible_points(const PlotArea& area, const std::vector<CurvePoint>& line,
                             const std::vector<double>& errors) {
  constexpr double kDistance = 1.0;
  ColoredPoints points;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    sum += errors[i];
    ++count;
    const Point2 at = area.at(line[i].at.x, line[i].at.y);
    const bool is_near = !points.at.empty() && i + 1 < line.size() &&
                         std::hypot(at.x - points.at.back().x, at.y - points.at.back().y) < kDistance;
    if (is_near) continue;
    points.at.push_back(at);
    points.errors.push_back(sum / count);
    sum = count = 0.0;
  }
  return points;
}

/// One line in colors; consecutive parts of nearly the same color are one mark.
void draw_colored(Drawing& drawing, const ColoredPoints& points, double most) {
  constexpr double kColors = 40.0;
  Polyline part{{}, {}, theme::kColoredWidth};
  double color_of_part = -1.0;
  for (std::size_t i = 1; i < points.at.size(); ++i) {
    const double color = most > 0.0 ? std::round(kColors * points.errors[i] / most) : 0.0;
    if (color != color_of_part) {
      if (part.points.size() > 1) drawing.marks.push_back(part);
      part.points = {points.at[i - 1]};
      part.color = error_color(color * most / kColors, most);
      color_of_part = color;
    }
    part.points.push_back(points.at[i]);
  }
  if (part.points.size() > 1) drawing.marks.push_back(part);
}

/// A single estimate has the middle of the colors of its error.
std::vector<LegendRow> path_legend(const FigureInput& input) {
  std::vector<LegendRow> rows = legend_rows(input, &eval::Evaluation::ate_m);
  if (input.runs.size() == 1) {
    rows[1].style = {error_color(0.5, 1.0)};
    rows[1].width = theme::kColoredWidth;
  }
  return rows;
}

/// Corner in which the fewest marks are, as factors of the free room to the right and down.
Point2 emptiest_corner(const Drawing& drawing, const PlotArea& area, const Point2& size) {
  constexpr std::array<Point2, 4> kCorners{{{1.0, 1.0}, {0.0, 1.0}, {1.0, 0.0}, {0.0, 0.0}}};
  Point2 best = kCorners[0];
  long fewest = std::numeric_limits<long>::max();
  for (const Point2& corner : kCorners) {
    const double left = area.top_left.x + corner.x * (area.bottom_right.x - area.top_left.x - size.x);
    const double top = area.top_left.y + corner.y * (area.bottom_right.y - area.top_left.y - size.y);
    long inside = 0;
    for (const Mark& mark : drawing.marks) {
      const auto* const line = std::get_if<Polyline>(&mark);
      if (line == nullptr) continue;
      inside += std::ranges::count_if(line->points, [&](const Point2& p) {
        return p.x > left && p.x < left + size.x && p.y > top && p.y < top + size.y;
      });
    }
    if (inside < fewest) best = corner;
    fewest = std::min(fewest, inside);
  }
  return best;
}

void draw_scale_bar(Drawing& drawing, const PlotArea& area, double font) {
  const double units_per_m = (area.bottom_right.x - area.top_left.x) / area.x.length();
  const double length_m = scale_bar_m(0.7 * area.x.length());
  const double length = length_m * units_per_m;
  const std::string text = fmt::format("{:g} m", length_m);
  const double width = std::max(length, text_width(text, font));
  const Point2 box{width + 1.6 * font, 2.4 * font};
  const Point2 corner = emptiest_corner(drawing, area, box);
  const double center =
      area.top_left.x + corner.x * (area.bottom_right.x - area.top_left.x - box.x) + 0.5 * box.x;
  const double top = area.top_left.y + corner.y * (area.bottom_right.y - area.top_left.y - box.y);
  const double y = top + 1.75 * font;
  const double left = center - 0.5 * length;
  drawing.marks.push_back(Polyline{{{left, y - 2.0},
                                    {left, y + 2.0},
                                    {left, y},
                                    {left + length, y},
                                    {left + length, y - 2.0},
                                    {left + length, y + 2.0}},
                                   theme::kBlack,
                                   0.9});
  drawing.marks.push_back(Label{{center, y - 0.45 * font}, text, font, Anchor::kMiddle, theme::kBlack});
}

void draw_arrow(Drawing& drawing, const PlotArea& area, double font, const std::string& name) {
  const double x = area.bottom_right.x - 1.2 * font;
  const double top = area.top_left.y + 1.6 * font;
  drawing.marks.push_back(Polyline{{{x, top + 2.2 * font}, {x, top}}, theme::kBlack, 0.9});
  drawing.marks.push_back(
      Polygon{{{x - 0.3 * font, top + 0.6 * font}, {x, top - 0.2 * font}, {x + 0.3 * font, top + 0.6 * font}},
              theme::kBlack});
  drawing.marks.push_back(Label{{x, top - 0.4 * font}, name, font, Anchor::kMiddle, theme::kBlack});
}

void draw_paths(Drawing& drawing, const PlotArea& area, const FigureInput& input, const ViewAxes& axes) {
  const PathView view = view_of(input);
  const auto [right, up, side] = axes;
  const std::vector<LegendRow> rows = path_legend(input);
  const auto place = [&area, right = right, up = up](const TimedPose& timed) {
    return area.at(timed.pose.p(right), timed.pose.p(up));
  };
  const auto add = [&](std::vector<Mark> marks) {
    drawing.marks.insert(drawing.marks.end(), marks.begin(), marks.end());
  };
  if (input.runs.size() == 1) {
    const LegendRow unmatched{.style = {theme::kGray}, .name = {}, .numbers = {}};
    draw_curve(drawing, area, curve_of(view.estimates.front(), right, up), unmatched);
    const ColoredPath path = colored_path(input, view.estimates.front(), right, up);
    for (std::size_t i = 0; i < path.lines.size(); ++i)
      draw_colored(drawing, visible_points(area, path.lines[i], path.errors[i]), path.most);
  } else {
    for (std::size_t i = 0; i < view.estimates.size(); ++i)
      draw_curve(drawing, area, curve_of(view.estimates[i], right, up), rows[i + 1]);
  }
  draw_curve(drawing, area, curve_of(view.truth, right, up), rows.front());
  for (std::size_t i = 0; i < view.estimates.size(); ++i) {
    if (view.estimates[i].empty()) continue;
    add(end_mark(place(view.estimates[i].back()), rows[i + 1].style.color));
  }
  add(start_mark(place(view.truth.front()), theme::kBlack));
  add(end_mark(place(view.truth.back()), theme::kBlack));
}

ChartPanel path_panel(const FigureInput& input, const PathView& view, const ViewAxes& axes) {
  const auto [right, up, side] = axes;
  ChartPanel panel{.x = {extent(view, right), axis_title(view, right)},
                   .y = {extent(view, up), axis_title(view, up)},
                   .draw = [&input, axes](Drawing& drawing, const PlotArea& area) {
                     draw_paths(drawing, area, input, axes);
                   }};
  return panel;
}

}  // namespace

Chart path_chart(const FigureInput& input, double font) {
  const PathView view = view_of(input);
  const ViewAxes axes = longest_axes(view);
  Chart chart{.title = "Trajectories", .panels = {}};
  chart.legend = path_legend(input);
  chart.legend_heads = {"RMSE [m]", "median", "max", "n"};
  chart.start_and_end = true;
  ChartPanel plan = path_panel(input, view, axes);
  ChartPanel side = path_panel(input, view, {axes[0], axes[2], axes[1]});
  // A path that is higher than wide is in a square, so that both views have the same scale.
  const double missing = std::max(plan.y.range.length(), side.y.range.length()) - plan.x.range.length();
  if (missing > 0.0) plan.x.range = {plan.x.range.low - 0.5 * missing, plan.x.range.high + 0.5 * missing};
  side.x.range = plan.x.range;
  plan.draw = [&input, axes, font](Drawing& drawing, const PlotArea& area) {
    draw_paths(drawing, area, input, axes);
    draw_scale_bar(drawing, area, font);
  };
  plan.shares_x_below = true;
  chart.panels = {plan, side};
  if (input.runs.size() == 1) {
    const auto& error = input.runs.front().evaluation->ate_m;
    if (error && error->max > 0.0) chart.color_bar = ColorBar{error->max, "position error [m]"};
  }
  return chart;
}

Drawing plan_map(const FigureInput& input, const FigureSize& size) {
  const PathView view = view_of(input);
  const double font = size.font_size_pt;
  Chart chart = path_chart(input, font);
  chart.title = "Map";
  ChartPanel plan = path_panel(input, view, {0, 1, 2});
  plan.draw = [&input, font, name = view.is_gnss ? "N" : "y"](Drawing& drawing, const PlotArea& area) {
    draw_paths(drawing, area, input, {0, 1, 2});
    draw_scale_bar(drawing, area, font);
    draw_arrow(drawing, area, font, name);
  };
  chart.panels = {plan};
  return draw_chart(chart, size);
}

}  // namespace stillpoint::report
