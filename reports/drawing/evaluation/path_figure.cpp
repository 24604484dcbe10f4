// SPDX-License-Identifier: BSD-3-Clause
// Views of trajectories: planes, and an orthographic one in 3-D.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/error.h"
#include "eval/io/nmea_file.h"
#include "eval/metrics/statistics.h"
#include "reports/drawing/curves.h"
#include "reports/drawing/evaluation/figures.h"

namespace stillpoint::report {
namespace {

/// Rows: what a view has to the right, and up.
using Projection = Eigen::Matrix<double, 2, 3>;

Projection plane_of(int right, int up) {
  Projection P = Projection::Zero();
  P(0, right) = P(1, up) = 1.0;
  return P;
}

/// Orthographic, from an azimuth of -60 and an elevation of 30 deg: x and y to the right, z up.
Projection oblique_view() {
  const double sine = std::sqrt(0.75);  // of 60 deg
  Projection P;
  P << sine, 0.5, 0.0, -0.25, 0.5 * sine, sine;
  return P;
}

struct PathView {
  std::vector<TimedPose> truth;
  std::vector<std::vector<TimedPose>> estimates;
  bool is_gnss = false;
  double axis_length_m = 0.0;  ///< of poses; 0: not drawn
  double map_margin_m = 0.0;   ///< of the map around the paths; 0: no map
};

ValueRange extent(const std::vector<TimedPose>& poses, int axis) {
  ValueRange range;
  for (const TimedPose& timed : poses) range.add(timed.pose.p(axis));
  return range;
}

PathView view_of(const FigureInput& input) {
  const Timestamp start = input.gt.poses.front().t;
  PathView view{.truth = timed_poses(input.gt, {}, start), .estimates = {}};
  view.is_gnss = input.gt.frame == eval::kGnssFrame;
  for (const PlottedRun& run : input.runs) view.estimates.push_back(aligned_poses(input, run));
  constexpr double kAxisLength = 0.05;  // of the longest side of the path
  constexpr double kMapMargin = 0.15;
  double longest_m = 0.0;
  for (int axis = 0; axis < 3; ++axis) longest_m = std::max(longest_m, extent(view.truth, axis).length());
  if (input.path.pose_axes) view.axis_length_m = kAxisLength * longest_m;
  if (input.path.map) view.map_margin_m = kMapMargin * longest_m;
  return view;
}

ValueRange extent(const PathView& view, int axis) {
  ValueRange range = extent(view.truth, axis);
  for (const std::vector<TimedPose>& estimate : view.estimates) {
    const ValueRange own = extent(estimate, axis);
    range.add(own.low);
    range.add(own.high);
  }
  range = padded(range, 0.05);
  const double margin_m = view.axis_length_m + (axis < 2 ? view.map_margin_m : 0.0);
  return {range.low - margin_m, range.high + margin_m};
}

/// Axes to the right and up of the plane in which the ground truth is longest, in the order of the alphabet,
/// and the third one.
std::array<int, 3> longest_axes(const PathView& view) {
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

Point2 projected(const Projection& P, const Eigen::Vector3d& p) {
  const Eigen::Vector2d at = P * p;
  return {at.x(), at.y()};
}

Curve curve_of(const std::vector<TimedPose>& poses, const Projection& P) {
  std::vector<CurvePoint> points;
  points.reserve(poses.size());
  for (const TimedPose& timed : poses) points.push_back({timed.t_s, projected(P, timed.pose.p)});
  return split_at_gaps(points);
}

/// What the path of a single estimate is colored by, with its times; finite.
std::vector<CurvePoint> coloring_errors(const FigureInput& input) {
  const PlottedRun& run = input.runs.front();
  std::vector<CurvePoint> errors;
  if (input.path.color == PathColor::kRelative) {
    errors = relative_series(input, run).position_m;
  } else {
    errors = error_points(input, run,
                          input.path.color == PathColor::kRotation ? &eval::PoseError::rotation_deg
                                                                   : &eval::PoseError::translation_m);
  }
  std::erase_if(errors, [](const CurvePoint& error) { return !std::isfinite(error.at.y); });
  if (errors.empty() && input.path.color != PathColor::kPosition)
    throw InputError("--path-color", "the estimate has no such errors; choose position");
  return errors;
}

std::string unit_of(PathColor color) { return color == PathColor::kRotation ? "[deg]" : "[m]"; }

std::string coloring_title(const FigureInput& input) {
  switch (input.path.color) {
    case PathColor::kPosition:
      return "position error [m]";
    case PathColor::kRotation:
      return "rotation error [deg]";
    case PathColor::kRelative:
      break;
  }
  return "relative position error [m] " + rpe_interval_text(input);
}

/// The positions of a run that have an error, and these errors, split at gaps.
struct ColoredPath {
  Curve lines;  ///< y and x of the view
  std::vector<std::vector<double>> errors;
};

ColoredPath colored_path(const FigureInput& input, const std::vector<TimedPose>& poses, const Projection& P) {
  constexpr double kSameTime_s = 1e-6;
  ColoredPath path;
  std::vector<CurvePoint> points;
  std::vector<double> errors;
  auto pose = poses.begin();
  for (const CurvePoint& error : coloring_errors(input)) {
    while (pose != poses.end() && pose->t_s < error.t_s - kSameTime_s) ++pose;
    if (pose == poses.end()) break;
    points.push_back({error.t_s, projected(P, pose->pose.p)});
    errors.push_back(error.at.y);
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

/// Limits of the colors: as requested, else 0 and a percentile of the errors.
ColorBar color_bar_of(const FigureInput& input) {
  std::vector<double> errors;
  for (const CurvePoint& error : coloring_errors(input)) errors.push_back(error.at.y);
  const double most = eval::percentile(errors, 0.01 * input.path.most_percentile).value_or(0.0);
  const ColorBar bar{.least = input.path.least_error,
                     .most = input.path.most_error.value_or(most),
                     .title = coloring_title(input)};
  if (bar.least > 0.0 && bar.most <= bar.least) {
    throw InputError("--colormap-min",
                     fmt::format("{:g} is not below the upper limit of {:g}; lower it", bar.least, bar.most));
  }
  return bar;
}

/// One line in colors; consecutive parts of nearly the same color are one mark.
void draw_colored(Drawing& drawing, const ColoredPoints& points, const ColorBar& bar) {
  constexpr double kColors = 40.0;
  const double length = bar.most - bar.least;
  Polyline part{{}, {}, theme::kColoredWidth};
  double color_of_part = -1.0;
  for (std::size_t i = 1; i < points.at.size(); ++i) {
    const double error = std::clamp(points.errors[i] - bar.least, 0.0, std::max(length, 0.0));
    const double color = length > 0.0 ? std::round(kColors * error / length) : 0.0;
    if (color != color_of_part) {
      if (part.points.size() > 1) drawing.marks.push_back(part);
      part.points = {points.at[i - 1]};
      part.color = error_color(color / kColors, 1.0);
      color_of_part = color;
    }
    part.points.push_back(points.at[i]);
  }
  if (part.points.size() > 1) drawing.marks.push_back(part);
}

/// A single estimate has the middle of the colors of its error, and the numbers of that error.
std::vector<LegendRow> path_legend(const FigureInput& input) {
  if (input.runs.size() != 1) return legend_rows(input, &eval::Evaluation::ate_m);
  const std::vector<std::optional<eval::Statistics>> found{statistics_of(coloring_errors(input))};
  std::vector<LegendRow> rows = input.path.color == PathColor::kPosition
                                    ? legend_rows(input, &eval::Evaluation::ate_m)
                                    : legend_rows(input, found);
  rows[1].style = {error_color(0.5, 1.0)};
  rows[1].width = theme::kColoredWidth;
  return rows;
}

/// Corner, or place between two, in which the fewest marks are, as factors of the free room to the right and
/// down.
Point2 emptiest_place(const Drawing& drawing, const PlotArea& area, const Point2& size) {
  constexpr std::array<Point2, 6> kPlaces{
      {{1.0, 1.0}, {0.0, 1.0}, {1.0, 0.0}, {0.0, 0.0}, {0.5, 1.0}, {0.5, 0.0}}};
  Point2 best = kPlaces[0];
  long fewest = std::numeric_limits<long>::max();
  for (const Point2& place : kPlaces) {
    const double left = area.top_left.x + place.x * (area.bottom_right.x - area.top_left.x - size.x);
    const double top = area.top_left.y + place.y * (area.bottom_right.y - area.top_left.y - size.y);
    long inside = 0;
    for (const Mark& mark : drawing.marks) {
      const auto* const line = std::get_if<Polyline>(&mark);
      if (line == nullptr) continue;
      inside += std::ranges::count_if(line->points, [&](const Point2& p) {
        return p.x > left && p.x < left + size.x && p.y > top && p.y < top + size.y;
      });
    }
    if (inside < fewest) best = place;
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
  const Point2 place = emptiest_place(drawing, area, box);
  const double center =
      area.top_left.x + place.x * (area.bottom_right.x - area.top_left.x - box.x) + 0.5 * box.x;
  const double top = area.top_left.y + place.y * (area.bottom_right.y - area.top_left.y - box.y);
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

/// Axes of about 20 poses of the truth and of each estimate.
void draw_pose_axes(Drawing& drawing, const PlotArea& area, const PathView& view, const Projection& P) {
  constexpr std::size_t kPoses = 20;
  const auto draw_axes = [&](const Pose& pose) {
    const Point2 from = projected(P, pose.p);
    for (int axis = 2; axis >= 0; --axis) {
      const Point2 to = projected(P, pose.p + view.axis_length_m * pose.R().col(axis));
      drawing.marks.push_back(Polyline{{area.at(from.x, from.y), area.at(to.x, to.y)},
                                       theme::kPoseAxes[static_cast<std::size_t>(axis)],
                                       theme::kEstimateWidth});
    }
  };
  const auto draw_some = [&](const std::vector<TimedPose>& poses) {
    const std::size_t step = std::max<std::size_t>(1, poses.size() / kPoses);
    for (std::size_t i = 0; i < poses.size(); i += step) draw_axes(poses[i].pose);
  };
  for (const std::vector<TimedPose>& estimate : view.estimates) draw_some(estimate);
  draw_some(view.truth);
}

/// Lines from matched poses to the ground truth at their times, at least 2 units apart.
void draw_correspondences(Drawing& drawing, const PlotArea& area, const FigureInput& input,
                          const Projection& P) {
  constexpr double kDistance = 2.0;
  constexpr double kSameTime_s = 1e-6;
  const PathView view = view_of(input);
  for (std::size_t r = 0; r < input.runs.size(); ++r) {
    auto pose = view.estimates[r].begin();
    auto truth = view.truth.begin();
    Point2 last{-1e9, -1e9};
    for (const CurvePoint& error : error_points(input, input.runs[r], &eval::PoseError::translation_m)) {
      while (pose != view.estimates[r].end() && pose->t_s < error.t_s - kSameTime_s) ++pose;
      while (truth != view.truth.end() && truth->t_s < error.t_s - kSameTime_s) ++truth;
      if (pose == view.estimates[r].end() || truth == view.truth.end()) break;
      const auto before = truth == view.truth.begin() ? truth : std::prev(truth);
      const double span_s = truth->t_s - before->t_s;
      const double weight = span_s > 0.0 ? std::clamp((error.t_s - before->t_s) / span_s, 0.0, 1.0) : 1.0;
      const Point2 of_truth = projected(P, before->pose.p + weight * (truth->pose.p - before->pose.p));
      const Point2 of_pose = projected(P, pose->pose.p);
      const Point2 from = area.at(of_truth.x, of_truth.y);
      const Point2 to = area.at(of_pose.x, of_pose.y);
      if (std::hypot(to.x - last.x, to.y - last.y) < kDistance) continue;
      drawing.marks.push_back(Polyline{{from, to}, theme::kFrame, theme::kGridWidth});
      last = to;
    }
  }
}

void draw_paths(Drawing& drawing, const PlotArea& area, const FigureInput& input, const Projection& P) {
  const PathView view = view_of(input);
  const std::vector<LegendRow> rows = path_legend(input);
  const auto place = [&](const TimedPose& timed) {
    const Point2 at = projected(P, timed.pose.p);
    return area.at(at.x, at.y);
  };
  const auto add = [&](std::vector<Mark> marks) {
    drawing.marks.insert(drawing.marks.end(), marks.begin(), marks.end());
  };
  if (input.path.correspondences) draw_correspondences(drawing, area, input, P);
  if (input.runs.size() == 1) {
    const LegendRow unmatched{.style = {theme::kGray}, .name = {}, .numbers = {}};
    draw_curve(drawing, area, curve_of(view.estimates.front(), P), unmatched);
    const ColoredPath path = colored_path(input, view.estimates.front(), P);
    const ColorBar bar = color_bar_of(input);
    for (std::size_t i = 0; i < path.lines.size(); ++i)
      draw_colored(drawing, visible_points(area, path.lines[i], path.errors[i]), bar);
  } else {
    for (std::size_t i = 0; i < view.estimates.size(); ++i)
      draw_curve(drawing, area, curve_of(view.estimates[i], P), rows[i + 1]);
  }
  draw_curve(drawing, area, curve_of(view.truth, P), rows.front());
  if (view.axis_length_m > 0.0) draw_pose_axes(drawing, area, view, P);
  for (std::size_t i = 0; i < view.estimates.size(); ++i) {
    if (view.estimates[i].empty()) continue;
    add(end_mark(place(view.estimates[i].back()), rows[i + 1].style.color));
  }
  add(start_mark(place(view.truth.front()), theme::kBlack));
  add(end_mark(place(view.truth.back()), theme::kBlack));
}

/// The map in the plot area, at 300 pixels per inch. Black becomes a gray on which lines are seen.
/// @param right axis to the right: 0 (x) or 1 (y)
void draw_map(Drawing& drawing, const PlotArea& area, const datasets::MapSource& map, int right) {
  const auto pixels_of = [](double length) {
    return static_cast<std::size_t>(
        std::clamp(std::ceil(length * theme::kPixelsPerInch / 72.0), 1.0, 4000.0));
  };
  const std::size_t columns = pixels_of(area.bottom_right.x - area.top_left.x);
  const std::size_t rows = pixels_of(area.bottom_right.y - area.top_left.y);
  const bool is_upright = right == 0;
  const ValueRange& x = is_upright ? area.x : area.y;
  const ValueRange& y = is_upright ? area.y : area.x;
  const std::vector<std::uint8_t> image = map({.x_low_m = x.low,
                                               .x_high_m = x.high,
                                               .y_low_m = y.low,
                                               .y_high_m = y.high,
                                               .columns = static_cast<int>(is_upright ? columns : rows),
                                               .rows = static_cast<int>(is_upright ? rows : columns)});
  Raster raster{area.top_left, area.bottom_right, columns, {}};
  raster.pixels.reserve(image.size());
  for (std::size_t k = 0; k < rows * columns; ++k) {
    const std::size_t down = k / columns;
    const std::size_t to_right = k % columns;
    // With y to the right, the rows of the image from below are columns, and x is up.
    const std::size_t pixel = is_upright ? k : (columns - 1 - to_right) * rows + (rows - 1 - down);
    for (std::size_t channel = 0; channel < 3; ++channel)
      raster.pixels.push_back(static_cast<unsigned char>(255 - (255 - image[3 * pixel + channel]) / 2));
  }
  drawing.marks.push_back(std::move(raster));
}

ChartPanel path_panel(const FigureInput& input, const PathView& view, int right, int up) {
  return {.x = {extent(view, right), axis_title(view, right)},
          .y = {extent(view, up), axis_title(view, up)},
          .draw = [&input, right, up, P = plane_of(right, up)](Drawing& drawing, const PlotArea& area) {
            if (input.path.map && right + up == 1) draw_map(drawing, area, input.path.map, right);
            draw_paths(drawing, area, input, P);
          }};
}

void add_scale_bar(ChartPanel& panel, double font) {
  panel.draw = [contents = panel.draw, font](Drawing& drawing, const PlotArea& area) {
    contents(drawing, area);
    draw_scale_bar(drawing, area, font);
  };
}

/// Plan and side view in which the ground truth is longest.
std::vector<ChartPanel> plan_and_side(const FigureInput& input, const PathView& view, double font) {
  const std::array<int, 3> axes =
      input.path.map ? std::array{0, 1, 2} : longest_axes(view);  // those of the map
  ChartPanel plan = path_panel(input, view, axes[0], axes[1]);
  ChartPanel side = path_panel(input, view, axes[0], axes[2]);
  // A path that is higher than wide is in a square, so that both views have the same scale.
  const double missing = std::max(plan.y.range.length(), side.y.range.length()) - plan.x.range.length();
  if (missing > 0.0) plan.x.range = {plan.x.range.low - 0.5 * missing, plan.x.range.high + 0.5 * missing};
  side.x.range = plan.x.range;
  add_scale_bar(plan, font);
  plan.shares_x_below = true;
  return {plan, side};
}

/// Box around the paths, and how it is drawn.
struct Box3 {
  std::array<ValueRange, 3> ranges;
  std::array<std::string, 3> titles;
  double font = theme::kFontSizePt;
  Projection P = oblique_view();

  [[nodiscard]] Point2 at(const PlotArea& area, const Eigen::Vector3d& p) const {
    const Point2 point = projected(P, p);
    return area.at(point.x, point.y);
  }
};

Eigen::Vector3d corner_of(const Box3& box, const std::array<bool, 3>& is_high) {
  Eigen::Vector3d corner;
  for (std::size_t k = 0; k < 3; ++k)
    corner(static_cast<int>(k)) = is_high[k] ? box.ranges[k].high : box.ranges[k].low;
  return corner;
}

/// One axis of the box: its grid on the floor or the back walls, and its ticks and title at a front edge.
void draw_box_axis(Drawing& drawing, const PlotArea& area, const Box3& box, int axis) {
  const double font = box.font;
  const auto k = static_cast<std::size_t>(axis);
  const Eigen::Vector3d edge = corner_of(box, {axis == 1, false, false});
  Eigen::Vector3d end = edge;
  end(axis) = box.ranges[k].high;
  const double edge_length =
      std::hypot(box.at(area, end).x - box.at(area, edge).x, box.at(area, end).y - box.at(area, edge).y);
  const Ticks ticks =
      nice_ticks(box.ranges[k], static_cast<std::size_t>(std::clamp(edge_length / (2.4 * font), 2.0, 8.0)));
  const Anchor anchor = axis == 1 ? Anchor::kLeft : Anchor::kRight;
  constexpr std::array<Point2, 3> kTextOffsets{{{-0.1, 1.15}, {0.4, 0.9}, {-0.4, 0.36}}};  // [em]
  double widest = 0.0;
  for (const double value : ticks.values) {
    Eigen::Vector3d on_back = corner_of(box, {false, true, false});
    on_back(axis) = value;
    for (const int along : {(axis + 1) % 3, (axis + 2) % 3}) {  // on the two planes that have this axis
      Eigen::Vector3d to = on_back;
      const ValueRange& range = box.ranges[static_cast<std::size_t>(along)];
      to(along) = along == 1 ? range.low : range.high;
      drawing.marks.push_back(
          Polyline{{box.at(area, on_back), box.at(area, to)}, theme::kGrid, theme::kGridWidth});
    }
    Eigen::Vector3d on_edge = edge;
    on_edge(axis) = value;
    const Point2 tick = box.at(area, on_edge);
    const std::string text = tick_text(value, ticks.step);
    widest = std::max(widest, text_width(text, font));
    drawing.marks.push_back(Label{{tick.x + kTextOffsets[k].x * font, tick.y + kTextOffsets[k].y * font},
                                  text,
                                  font,
                                  anchor,
                                  theme::kBlack});
  }
  const Point2 middle = box.at(area, 0.5 * (edge + end));
  const std::array<Point2, 3> titles{{{middle.x - 0.4 * font, middle.y + 2.7 * font},
                                      {middle.x + widest + 0.4 * font, middle.y + 2.2 * font},
                                      {middle.x - widest - 0.9 * font, middle.y}}};
  drawing.marks.push_back(
      Label{titles[k], box.titles[k], font, axis == 2 ? Anchor::kMiddle : anchor, theme::kBlack, axis == 2});
}

/// Floor and both back walls.
void draw_box_axes(Drawing& drawing, const PlotArea& area, const Box3& box) {
  for (int axis = 0; axis < 3; ++axis) draw_box_axis(drawing, area, box, axis);
  const auto edge = [&](const std::array<bool, 3>& from, const std::array<bool, 3>& to) {
    drawing.marks.push_back(Polyline{{box.at(area, corner_of(box, from)), box.at(area, corner_of(box, to))},
                                     theme::kFrame,
                                     theme::kFrameWidth});
  };
  edge({false, false, false}, {true, false, false});
  edge({true, false, false}, {true, true, false});
  edge({false, false, false}, {false, false, true});
  for (const auto& to : {std::array{true, true, false}, {false, false, false}, {false, true, true}})
    edge({false, true, false}, to);
}

/// The orthographic view, with room for the texts around the box.
ChartPanel view_3d(const FigureInput& input, const PathView& view, const FigureSize& size) {
  constexpr double kLeastHeight = 0.15;  // of the longer side of the floor
  Box3 box{.ranges = {extent(view, 0), extent(view, 1), extent(view, 2)},
           .titles = {axis_title(view, 0), axis_title(view, 1), axis_title(view, 2)},
           .font = size.font_size_pt};
  const double longest = std::max(box.ranges[0].length(), box.ranges[1].length());
  for (ValueRange& range : box.ranges) {
    const double pad = std::max(0.0, 0.5 * (kLeastHeight * longest - range.length()));
    range = {range.low - pad, range.high + pad};
  }
  ChartPanel panel{.x = {}, .y = {}, .has_axes = false};
  for (int corner = 0; corner < 8; ++corner) {
    const Point2 at =
        projected(box.P, corner_of(box, {(corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0}));
    panel.x.range.add(at.x);
    panel.y.range.add(at.y);
  }
  const double em = size.font_size_pt / (size.width_mm * 72.0 / 25.4);  // of the width
  const double per_em = std::max(panel.x.range.length(), panel.y.range.length()) * em / (1.0 - 8.0 * em);
  panel.x.range = {panel.x.range.low - 4.2 * per_em, panel.x.range.high + 3.2 * per_em};
  panel.y.range = {panel.y.range.low - 1.6 * per_em, panel.y.range.high + 0.3 * per_em};
  panel.draw = [&input, box = std::move(box)](Drawing& drawing, const PlotArea& area) {
    draw_box_axes(drawing, area, box);
    draw_paths(drawing, area, input, box.P);
  };
  return panel;
}

}  // namespace

Chart path_chart(const FigureInput& input, const FigureSize& size) {
  const PathView view = view_of(input);
  Chart chart{.title = "Trajectories", .panels = {}};
  chart.legend = path_legend(input);
  chart.legend_heads = {"RMSE " + (input.runs.size() == 1 ? unit_of(input.path.color) : "[m]"), "median",
                        "max", "n"};
  chart.start_and_end = true;
  if (!input.path.mode) {
    chart.panels = plan_and_side(input, view, size.font_size_pt);
  } else if (*input.path.mode == PlotMode::kXyz) {
    chart.panels = {view_3d(input, view, size)};
  } else {
    constexpr std::array<std::array<int, 2>, 6> kPlanes{{{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}}};
    const auto [right, up] = kPlanes[static_cast<std::size_t>(*input.path.mode)];
    chart.panels = {path_panel(input, view, right, up)};
    add_scale_bar(chart.panels.front(), size.font_size_pt);
  }
  if (input.path.pose_axes) chart.note = "Axes of poses: x red, y green, z blue.";
  if (!input.path.map_credit.empty())
    chart.note += (chart.note.empty() ? "Map: " : " Map: ") + input.path.map_credit;
  if (input.runs.size() == 1) {
    const ColorBar bar = color_bar_of(input);
    if (bar.most > bar.least) chart.color_bar = bar;
  }
  return chart;
}

Drawing plan_map(const FigureInput& input, const FigureSize& size) {
  const PathView view = view_of(input);
  const double font = size.font_size_pt;
  Chart chart = path_chart(input, size);
  chart.title = "Map";
  ChartPanel plan = path_panel(input, view, 0, 1);
  add_scale_bar(plan, font);
  plan.draw = [contents = plan.draw, font, name = view.is_gnss ? "N" : "y"](Drawing& drawing,
                                                                            const PlotArea& area) {
    contents(drawing, area);
    draw_arrow(drawing, area, font, name);
  };
  chart.panels = {plan};
  return draw_chart(chart, size);
}

}  // namespace stillpoint::report
