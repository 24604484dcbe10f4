// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/evaluation/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/orientations.h"
#include "reports/drawing/evaluation/figure_parts.h"

namespace stillpoint::report {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A value of each pose over time, of truth and estimates.
Curves pose_curves(const FigureInput& input, const std::function<double(const Pose&)>& value,
                   double most_jump) {
  const Timestamp start = input.gt.poses.front().t;
  const auto curve_of = [&](const std::vector<TimedPose>& poses) {
    std::vector<CurvePoint> points;
    points.reserve(poses.size());
    for (const TimedPose& timed : poses) points.push_back({timed.t_s, {timed.t_s, value(timed.pose)}});
    return split_at_gaps(points, most_jump);
  };
  Curves curves{curve_of(timed_poses(input.gt, {}, start))};
  for (const PlottedRun& run : input.runs) curves.push_back(curve_of(aligned_poses(input, run)));
  return curves;
}

Chart axes_chart(const FigureInput& input, const FigureSize& size) {
  Chart chart = stacked_chart(input, &eval::Evaluation::ate_m, "m");
  constexpr std::array<const char*, 3> kTitles{"x [m]", "y [m]", "z [m]"};
  for (int axis = 0; axis < 3; ++axis) {
    Curves curves = pose_curves(
        input, [axis](const Pose& pose) { return pose.p(axis); }, std::numeric_limits<double>::infinity());
    ChartPanel panel{.x = {duration(input), "time [s]"},
                     .y = {padded(y_range(curves), 0.06), kTitles[static_cast<std::size_t>(axis)]},
                     .height = panel_height(size)};
    panel.draw = drawing_of(std::move(curves), chart.legend);
    chart.panels.push_back(std::move(panel));
  }
  share_x(chart);
  return chart;
}

/// Roll, pitch and yaw [deg] of R = Rz(yaw) Ry(pitch) Rx(roll).
std::array<double, 3> roll_pitch_yaw_deg(const Pose& pose) {
  const Eigen::Matrix3d R = pose.R();
  return {kDegrees * std::atan2(R(2, 1), R(2, 2)), kDegrees * std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
          kDegrees * std::atan2(R(1, 0), R(0, 0))};
}

Chart rotation_chart(const FigureInput& input, const FigureSize& size) {
  require_rotations(input, "rotation");
  constexpr double kWrap_deg = 180.0;
  Chart chart = stacked_chart(input, &eval::Evaluation::ate_deg, "deg");
  constexpr std::array<const char*, 3> kTitles{"roll [deg]", "pitch [deg]", "yaw [deg]"};
  for (std::size_t angle = 0; angle < 3; ++angle) {
    Curves curves = pose_curves(
        input, [angle](const Pose& pose) { return roll_pitch_yaw_deg(pose)[angle]; }, kWrap_deg);
    ChartPanel panel{.x = {duration(input), "time [s]"},
                     .y = {padded(y_range(curves), 0.06), kTitles[angle]},
                     .height = panel_height(size)};
    if (panel.y.range.length() > kWrap_deg) panel.y.step = 0.5 * kWrap_deg;
    panel.draw = drawing_of(std::move(curves), chart.legend);
    chart.panels.push_back(std::move(panel));
  }
  share_x(chart);
  return chart;
}

/// What a box shows of a list of values.
struct BoxValues {
  double low = 0.0;  ///< 5th percentile
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double high = 0.0;  ///< 95th percentile
  double rmse = 0.0;
};
constexpr const char* kBoxNote =
    "Boxes: quartiles and median; whiskers: 5th and 95th percentile; dots: RMSE.";
constexpr const char* kViolinNote =
    "Violins: density of the errors. Boxes: quartiles and median; whiskers: 5th and 95th percentile; dots: "
    "RMSE.";

/// @param values not empty
BoxValues box_values(const std::vector<double>& values) {
  const double rmse = eval::statistics(values)->rmse;
  const auto at = [&](double fraction) { return *eval::percentile(values, fraction); };
  return {at(0.05), at(0.25), at(0.5), at(0.75), at(0.95), rmse};
}

/// Density of values at equal steps from `low` to `high`, relative to its largest.
struct Violin {
  double low = 0.0;
  double high = 0.0;
  std::vector<double> density;  ///< empty: not drawn
};

/// Gaussian kernel density between the ends of the whiskers, with the bandwidth 0.9 min(s, IQR / 1.34)
/// n^(-1/5) (Silverman, Density Estimation for Statistics and Data Analysis, 1986, eq. 3.31). Empty if the
/// values are equal.
Violin violin_of(const std::vector<double>& values, const BoxValues& box) {
  constexpr std::size_t kPoints = 65;
  const double spread = (box.upper_quartile - box.lower_quartile) / 1.34;
  const double n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value / n;
  const double deviation = std::sqrt(std::max(0.0, box.rmse * box.rmse - mean * mean));
  const double bandwidth = 0.9 * std::min(deviation, spread) * std::pow(n, -0.2);
  Violin violin{box.low, box.high, {}};
  if (!(bandwidth > 0.0) || !(box.high > box.low)) return violin;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double at = box.low + (box.high - box.low) * static_cast<double>(i) / (kPoints - 1);
    double sum = 0.0;
    for (const double value : values) sum += std::exp(-0.5 * std::pow((value - at) / bandwidth, 2));
    violin.density.push_back(sum);
  }
  const double largest = std::ranges::max(violin.density);
  for (double& density : violin.density) density /= largest;
  return violin;
}

/// A box across the axis of the values, at `place` of the other axis, in front of a violin.
struct PlacedBox {
  BoxValues values;
  double place = 0.0;
  double half_width = 0.3;
  bool is_horizontal = false;
  Color color;
  Violin violin = {};
};

Color tint(const Color& color) {
  constexpr double kWeight = 0.25;
  const auto lighter = [](int part) {
    return static_cast<int>(std::lround(255.0 - kWeight * (255.0 - part)));
  };
  return {lighter(color.red), lighter(color.green), lighter(color.blue)};
}

/// Both sides of a violin, of three times the width of the box.
std::vector<Point2> violin_outline(const PlotArea& area, const PlacedBox& box) {
  const std::size_t count = box.violin.density.size();
  std::vector<Point2> outline;
  for (std::size_t k = 0; k < 2 * count; ++k) {
    const std::size_t i = k < count ? k : 2 * count - 1 - k;
    const double value = box.violin.low + (box.violin.high - box.violin.low) * static_cast<double>(i) /
                                              static_cast<double>(count - 1);
    const double place = box.place + (k < count ? 3.0 : -3.0) * box.half_width * box.violin.density[i];
    outline.push_back(box.is_horizontal ? area.at(value, place) : area.at(place, value));
  }
  return outline;
}

void draw_box(Drawing& drawing, const PlotArea& area, const PlacedBox& box) {
  const auto at = [&](double value, double across) {
    const double place = box.place + across * box.half_width;
    return box.is_horizontal ? area.at(value, place) : area.at(place, value);
  };
  const BoxValues& v = box.values;
  const bool has_violin = !box.violin.density.empty();
  if (has_violin) drawing.marks.push_back(Polygon{violin_outline(area, box), tint(box.color)});
  const auto line = [&](Point2 from, Point2 to, double width) {
    drawing.marks.push_back(Polyline{{from, to}, box.color, width});
  };
  line(at(v.low, 0.0), at(v.lower_quartile, 0.0), 0.8);
  line(at(v.upper_quartile, 0.0), at(v.high, 0.0), 0.8);
  line(at(v.low, -0.5), at(v.low, 0.5), 0.8);
  line(at(v.high, -0.5), at(v.high, 0.5), 0.8);
  const std::vector<Point2> outline{at(v.lower_quartile, -1.0), at(v.upper_quartile, -1.0),
                                    at(v.upper_quartile, 1.0), at(v.lower_quartile, 1.0),
                                    at(v.lower_quartile, -1.0)};
  drawing.marks.push_back(Polygon{outline, has_violin ? theme::kWhite : tint(box.color)});
  drawing.marks.push_back(Polyline{outline, box.color, 0.8});
  line(at(v.median, -1.0), at(v.median, 1.0), 1.6);
  drawing.marks.push_back(Disc{at(v.rmse, 0.0), 1.5, box.color});
}

ChartPanel box_panel(std::vector<PlacedBox> boxes, const ChartAxis& places, const char* title,
                     double height) {
  ValueRange values;
  for (const PlacedBox& box : boxes) {
    values.add(box.values.high);
    values.add(box.values.rmse);
  }
  const ChartAxis value_axis{from_zero(values), title};
  const bool is_horizontal = !boxes.empty() && boxes.front().is_horizontal;
  return {.x = is_horizontal ? value_axis : places,
          .y = is_horizontal ? places : value_axis,
          .height = height,
          .draw = [boxes = std::move(boxes)](Drawing& drawing, const PlotArea& area) {
            for (const PlacedBox& box : boxes) draw_box(drawing, area, box);
          }};
}

/// The finite errors of a run.
std::vector<double> error_values(const PlottedRun& run, double eval::PoseError::*error) {
  std::vector<double> values;
  for (const eval::PoseError& pose : run.evaluation->per_pose) {
    if (std::isfinite(pose.*error)) values.push_back(pose.*error);
  }
  return values;
}

Chart box_chart(const FigureInput& input, const FigureSize& size) {
  Chart chart = stacked_chart(input, &eval::Evaluation::ate_m, "m");
  const double count = static_cast<double>(input.runs.size());
  const auto add = [&](double eval::PoseError::*error, const char* title) {
    ChartAxis names{{0.4 - count, 0.6}, "", {}};
    std::vector<PlacedBox> boxes;
    for (std::size_t i = 0; i < input.runs.size(); ++i) {
      const double place = -static_cast<double>(i);
      names.named_ticks.emplace_back(place, input.runs[i].name);
      const std::vector<double> values = error_values(input.runs[i], error);
      if (values.empty()) continue;
      const BoxValues box = box_values(values);
      const Color color = chart.legend[i + 1].style.color;
      boxes.push_back({box, place, 0.14, true, color, violin_of(values, box)});
    }
    chart.panels.push_back(
        box_panel(std::move(boxes), names, title, (count + 0.6) * 2.2 * size.font_size_pt));
  };
  add(&eval::PoseError::translation_m, "position error [m]");
  if (has_rotation_errors(input)) add(&eval::PoseError::rotation_deg, "rotation error [deg]");
  drop_truth(chart);
  fill_samples(chart);
  chart.note = kViolinNote;
  return chart;
}

/// Fraction of the errors that are at most as large, over the error.
Curve cumulative(std::vector<double> values) {
  std::ranges::sort(values);
  std::vector<CurvePoint> line;
  const double count = static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    line.push_back({0.0, {values[i], static_cast<double>(i) / count}});
    line.push_back({0.0, {values[i], static_cast<double>(i + 1) / count}});
  }
  return line.empty() ? Curve{} : Curve{line};
}

Chart cdf_chart(const FigureInput& input, const FigureSize& size) {
  Chart chart = stacked_chart(input, &eval::Evaluation::ate_m, "m");
  const auto add = [&](double eval::PoseError::*error, const char* title) {
    Curves curves{{}};
    ValueRange errors;
    for (const PlottedRun& run : input.runs) {
      curves.push_back(cumulative(error_values(run, error)));
      for (const std::vector<CurvePoint>& line : curves.back()) errors.add(line.back().at.x);
    }
    ChartPanel panel{.x = {from_zero(errors), title},
                     .y = {{0.0, 1.02}, "fraction of poses"},
                     .height = 1.5 * panel_height(size)};
    panel.draw = drawing_of(std::move(curves), chart.legend);
    chart.panels.push_back(std::move(panel));
  };
  add(&eval::PoseError::translation_m, "position error [m]");
  if (has_rotation_errors(input)) add(&eval::PoseError::rotation_deg, "rotation error [deg]");
  drop_truth(chart);
  return chart;
}

/// Step of the segment lengths: the largest of 1, 2, 5, ... of which ten are at most the path length.
double segment_step_m(double path_m) { return scale_bar_m(3.0 * path_m / 10.0); }

Chart rpe_chart(const FigureInput& input, const FigureSize& size) {
  constexpr int kLengths = 5;
  constexpr double kTolerance = 0.02;  // of the length of a segment
  const double total_m = TraveledDistance(input.gt).total_m();
  const double step_m = total_m > 0.0 ? segment_step_m(total_m) : 1.0;
  Chart chart{.title = {}, .panels = {}, .legend = legend_rows(input, nullptr)};
  std::array<std::vector<PlacedBox>, 2> boxes;
  const double count = static_cast<double>(input.runs.size());
  for (std::size_t i = 0; i < input.runs.size(); ++i) {
    const PlottedRun& run = input.runs[i];
    eval::PoseMatches matches(
        input.gt, *run.est,
        eval::associate_interpolated(input.gt, *run.est, input.max_gap_s, input.offset_s));
    matches.align(run.evaluation->alignment.S_w_v);
    const std::vector<double> lengths_m = eval::path_lengths(matches, eval::PathOf::kGroundTruth);
    for (int k = 1; k <= kLengths; ++k) {
      const double length_m = k * step_m;
      const auto pairs = eval::pairs_over_meters(lengths_m, length_m, kTolerance * length_m).pairs;
      if (pairs.size() < eval::kFewRpePairs) continue;  // too few for quartiles
      const eval::RelativeErrors errors = eval::relative_errors(matches, pairs, false);
      const double place = k + 0.8 * ((static_cast<double>(i) + 0.5) / count - 0.5);
      const Color color = chart.legend[i + 1].style.color;
      boxes[0].push_back({box_values(errors.translation_m), place, 0.3 / count, false, color});
      if (run.evaluation->ate_deg)
        boxes[1].push_back({box_values(errors.rotation_deg), place, 0.3 / count, false, color});
    }
  }
  if (boxes[0].empty())
    throw InputError("--figure rpe",
                     "no estimate has 10 segments of one length with ground truth at both ends");
  ChartAxis lengths{{0.5, kLengths + 0.5}, "length of the segments [m]"};
  for (int k = 1; k <= kLengths; ++k) lengths.named_ticks.emplace_back(k, tick_text(k * step_m, step_m));
  const double height = 1.4 * panel_height(size);
  chart.panels.push_back(box_panel(std::move(boxes[0]), lengths, "relative error [m]", height));
  if (!boxes[1].empty())
    chart.panels.push_back(box_panel(std::move(boxes[1]), lengths, "relative error [deg]", height));
  share_x(chart);
  drop_truth(chart);
  fill_samples(chart);
  chart.note = kBoxNote;
  return chart;
}

/// Speed [m/s] and rotation rate [deg/s] between poses at least 0.2 s apart, at the middle of their times.
struct SpeedCurves {
  Curve linear;
  Curve angular;
};

SpeedCurves speeds(const std::vector<TimedPose>& poses) {
  constexpr double kInterval_s = 0.2;
  constexpr double kMostInterval_s = 0.5;  // a longer one would hide the motion in it
  std::vector<CurvePoint> linear;
  std::vector<CurvePoint> angular;
  std::size_t j = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    while (j < poses.size() && poses[j].t_s - poses[i].t_s < kInterval_s) ++j;
    if (j == poses.size()) break;
    const double dt_s = poses[j].t_s - poses[i].t_s;
    if (dt_s > kMostInterval_s) continue;
    const double t_s = 0.5 * (poses[i].t_s + poses[j].t_s);
    const double angle = poses[i].pose.q.angularDistance(poses[j].pose.q);
    linear.push_back({t_s, {t_s, (poses[j].pose.p - poses[i].pose.p).norm() / dt_s}});
    angular.push_back({t_s, {t_s, kDegrees * angle / dt_s}});
  }
  return {split_at_gaps(linear), split_at_gaps(angular)};
}

Chart speed_chart(const FigureInput& input, const FigureSize& size) {
  Chart chart{.title = {}, .panels = {}, .legend = legend_rows(input, nullptr)};
  const Timestamp start = input.gt.poses.front().t;
  Curves linear;
  Curves angular;
  const auto add = [&](const std::vector<TimedPose>& poses) {
    SpeedCurves curves = speeds(poses);
    linear.push_back(std::move(curves.linear));
    angular.push_back(std::move(curves.angular));
  };
  add(timed_poses(input.gt, {}, start));
  for (const PlottedRun& run : input.runs) add(aligned_poses(input, run));
  const auto add_panel = [&](Curves curves, const char* title) {
    ChartPanel panel{.x = {duration(input), "time [s]"},
                     .y = {from_zero(y_range(curves)), title},
                     .height = 1.3 * panel_height(size)};
    panel.draw = drawing_of(std::move(curves), chart.legend);
    chart.panels.push_back(std::move(panel));
  };
  if (y_range(linear).empty()) throw InputError("--figure speed", "no two poses are 0.2 to 0.5 s apart");
  add_panel(std::move(linear), "speed [m/s]");
  if (has_rotation_errors(input)) add_panel(std::move(angular), "rotation rate [deg/s]");
  share_x(chart);
  return chart;
}

Chart chart_of(FigureKind kind, const FigureInput& input, const FigureSize& size) {
  switch (kind) {
    case FigureKind::kPath:
      return path_chart(input, size);
    case FigureKind::kAxes:
      return axes_chart(input, size);
    case FigureKind::kRotation:
      return rotation_chart(input, size);
    case FigureKind::kError:
      return error_chart(input, size);
    case FigureKind::kRelative:
      return relative_chart(input, size);
    case FigureKind::kTransform:
      return transform_chart(input, size);
    case FigureKind::kRpe:
      return rpe_chart(input, size);
    case FigureKind::kBox:
      return box_chart(input, size);
    case FigureKind::kCdf:
      return cdf_chart(input, size);
    case FigureKind::kHistogram:
      return histogram_chart(input, size);
    case FigureKind::kBars:
      return bars_chart(input, size);
    case FigureKind::kSpeed:
      break;
  }
  return speed_chart(input, size);
}

}  // namespace

std::vector<TimedPose> aligned_poses(const FigureInput& input, const PlottedRun& run) {
  const eval::Similarity& S_w_v = run.evaluation->alignment.S_w_v;
  std::vector<TimedPose> poses = timed_poses(*run.est, S_w_v, input.gt.poses.front().t, input.offset_s);
  if (run.evaluation->rotation_source == eval::RotationSource::kPositions) return poses;
  const eval::PoseMatches matches(
      input.gt, *run.est, eval::associate_interpolated(input.gt, *run.est, input.max_gap_s, input.offset_s));
  const eval::Similarity completed = eval::complete_rotation(matches, S_w_v).S_w_v;
  const Eigen::Quaterniond R = completed.T_w_v.q * S_w_v.T_w_v.q.conjugate();
  for (TimedPose& timed : poses) timed.pose.q = R * timed.pose.q;
  return poses;
}

std::vector<LegendRow> legend_rows(const FigureInput& input,
                                   std::span<const std::optional<eval::Statistics>> errors) {
  std::vector<LegendRow> rows{
      {.style = theme::kTruth, .width = theme::kTruthWidth, .name = "ground truth", .numbers = {}}};
  for (std::size_t i = 0; i < input.runs.size(); ++i) {
    LegendRow row{.style = theme::style_of_estimate(i), .name = input.runs[i].name, .numbers = {}};
    if (i < errors.size()) {
      const std::optional<eval::Statistics>& found = errors[i];
      row.numbers = found ? std::vector<std::string>{short_number(found->rmse), short_number(found->median),
                                                     short_number(found->max), std::to_string(found->count)}
                          : std::vector<std::string>(4, "n/a");
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<LegendRow> legend_rows(const FigureInput& input, ErrorStatistics error) {
  std::vector<std::optional<eval::Statistics>> errors;
  for (const PlottedRun& run : input.runs) {
    if (error != nullptr) errors.push_back(run.evaluation->*error);
  }
  return legend_rows(input, errors);
}

Drawing figure(FigureKind kind, const FigureInput& input, const FigureSize& size) {
  Chart chart = chart_of(kind, input, size);
  for (const auto& [value, name] : enum_names(kind)) {
    if (value == kind) chart.title = "Trajectory evaluation: " + std::string(name);
  }
  return draw_chart(chart, size);
}

}  // namespace stillpoint::report
