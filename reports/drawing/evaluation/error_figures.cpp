// SPDX-License-Identifier: BSD-3-Clause
// Errors, absolute and relative, over time, the index of a pose, or distance.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "eval/metrics/rpe.h"
#include "reports/drawing/evaluation/figure_parts.h"

namespace stillpoint::report {
namespace {

/// Places of the poses of the estimates on the axis of errors.
class ErrorPlaces {
 public:
  ErrorPlaces(const FigureInput& input, ErrorAxis axis)
      : input_(input), axis_(axis), distance_(axis == ErrorAxis::kDistance ? input.gt : Trajectory{}) {}

  [[nodiscard]] const FigureInput& input() const { return input_; }
  [[nodiscard]] ChartAxis axis() const {
    if (axis_ == ErrorAxis::kTime) return {duration(input_), "time [s]"};
    if (axis_ == ErrorAxis::kDistance)
      return {{0.0, std::max(distance_.total_m(), 1e-3)}, "distance traveled [m]"};
    double last = 1.0;
    for (const PlottedRun& run : input_.runs)
      last = std::max(last, static_cast<double>(run.est->poses.size()) - 1.0);
    return {{0.0, last}, "index of the pose"};
  }

  /// @param t_s time since the first pose of the ground truth
  [[nodiscard]] double at(const PlottedRun& run, double t_s) const {
    if (axis_ == ErrorAxis::kTime) return t_s;
    if (axis_ == ErrorAxis::kDistance) return distance_.at(t_s);
    constexpr double kSameTime_s = 1e-6;
    const Timestamp t = after(input_.gt.poses.front().t, t_s - input_.offset_s - kSameTime_s);
    return static_cast<double>(std::ranges::lower_bound(run.est->poses, t, {}, &StampedPose::t) -
                               run.est->poses.begin());
  }

 private:
  const FigureInput& input_;
  ErrorAxis axis_;
  TraveledDistance distance_;
};

/// Errors of each run, by time.
using ErrorsOfRuns = std::vector<std::vector<CurvePoint>>;

void add_errors(Chart& chart, const ErrorsOfRuns& errors, const ErrorPlaces& places,
                const std::string& title) {
  Curves curves{{}};  // the ground truth has no error
  for (std::size_t i = 0; i < errors.size(); ++i) {
    Curve curve = split_at_gaps(errors[i]);
    for (std::vector<CurvePoint>& line : curve) {
      for (CurvePoint& point : line) point.at.x = places.at(places.input().runs[i], point.t_s);
    }
    curves.push_back(std::move(curve));
  }
  if (y_range(curves).empty()) return;
  ChartPanel panel{.x = places.axis(), .y = {from_zero(y_range(curves)), title}};
  const Curve single = places.input().runs.size() == 1 ? curves.back() : Curve{};
  panel.draw = drawing_of(std::move(curves), chart.legend);
  add_statistics(panel, single);
  chart.panels.push_back(std::move(panel));
}

/// Sets the heights of the panels, and the legend.
Chart finished(Chart chart, const FigureInput& input, const FigureSize& size) {
  for (std::size_t i = 0; i < chart.panels.size(); ++i) {
    chart.panels[i].height = panel_height(size);
    chart.panels[i].shares_x_below =
        i + 1 < chart.panels.size() && chart.panels[i].x.title == chart.panels[i + 1].x.title;
  }
  drop_truth(chart);
  if (input.runs.size() == 1) {
    chart.legend.push_back({.style = theme::kMean, .name = "mean ± std", .numbers = {}});
    chart.legend.push_back({.style = theme::kMedian, .name = "median", .numbers = {}});
  }
  return chart;
}

ErrorsOfRuns errors_of_poses(const FigureInput& input, double eval::PoseError::*error) {
  ErrorsOfRuns errors;
  for (const PlottedRun& run : input.runs) errors.push_back(error_points(input, run, error));
  return errors;
}

/// Of whole transformations of the poses; empty for a run whose orientations cannot be compared.
ErrorsOfRuns whole_errors_of_poses(const FigureInput& input) {
  ErrorsOfRuns errors = errors_of_poses(input, &eval::PoseError::translation_m);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    for (std::size_t k = 0; k < errors[i].size(); ++k) {
      errors[i][k].at.y = eval::whole_transformation_error(
          errors[i][k].at.y, input.runs[i].evaluation->per_pose[k].rotation_deg);
    }
  }
  return errors;
}

std::vector<RelativeSeries> all_relative_series(const FigureInput& input) {
  std::vector<RelativeSeries> all;
  for (const PlottedRun& run : input.runs) all.push_back(relative_series(input, run));
  return all;
}

ErrorsOfRuns errors_in(const std::vector<RelativeSeries>& all,
                       std::vector<CurvePoint> RelativeSeries::*errors) {
  ErrorsOfRuns of_runs;
  for (const RelativeSeries& series : all) of_runs.push_back(series.*errors);
  return of_runs;
}

/// A chart without panels, whose legend has the statistics of the errors.
Chart chart_of_errors(const FigureInput& input, const ErrorsOfRuns& errors, const std::string& unit) {
  Chart chart{.title = {}, .panels = {}};
  std::vector<std::optional<eval::Statistics>> statistics;
  for (const std::vector<CurvePoint>& points : errors) statistics.push_back(statistics_of(points));
  chart.legend = legend_rows(input, statistics);
  chart.legend_heads = {"RMSE" + unit, "median", "max", "n"};
  return chart;
}

bool are_empty(const ErrorsOfRuns& errors) {
  return std::ranges::all_of(errors, [](const std::vector<CurvePoint>& points) { return points.empty(); });
}

}  // namespace

std::vector<CurvePoint> error_points(const FigureInput& input, const PlottedRun& run,
                                     double eval::PoseError::*error) {
  // The strict protocols add the offset to the stamps of the estimate, the others only when associating.
  const double offset_s = run.evaluation->protocol.starts_with("strict:") ? 0.0 : input.offset_s;
  std::vector<CurvePoint> points;
  points.reserve(run.evaluation->per_pose.size());
  for (const eval::PoseError& pose : run.evaluation->per_pose) {
    const double t_s = seconds_between(input.gt.poses.front().t, pose.t) + offset_s;
    points.push_back({t_s, {t_s, pose.*error}});
  }
  return points;
}

std::optional<eval::Statistics> statistics_of(std::span<const CurvePoint> points) {
  std::vector<double> values;
  for (const CurvePoint& point : points) {
    if (std::isfinite(point.at.y)) values.push_back(point.at.y);
  }
  return eval::statistics(values);
}

RelativeSeries relative_series(const FigureInput& input, const PlottedRun& run) {
  eval::PoseMatches matches(
      input.gt, *run.est, eval::associate_interpolated(input.gt, *run.est, input.max_gap_s, input.offset_s));
  matches.align(run.evaluation->alignment.S_w_v);
  const auto pairs = eval::strict_pairs(matches, input.rpe_delta, input.rpe_unit).pairs;
  const std::vector<double> distances_m = eval::point_distance_errors(matches, pairs);
  const bool has_rotations = run.evaluation->ate_deg.has_value();
  const eval::RelativeErrors errors =
      has_rotations ? eval::relative_errors(matches, pairs, false) : eval::RelativeErrors{};
  RelativeSeries series;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double t_s = seconds_between(input.gt.poses.front().t, matches.time(pairs[k].to)) + input.offset_s;
    const auto point = [&](double error) { return CurvePoint{t_s, {t_s, error}}; };
    series.distance_m.push_back(point(distances_m[k]));
    if (!has_rotations) continue;
    series.position_m.push_back(point(errors.translation_m[k]));
    series.rotation_deg.push_back(point(errors.rotation_deg[k]));
    series.transform.push_back(
        point(eval::whole_transformation_error(errors.translation_m[k], errors.rotation_deg[k])));
  }
  return series;
}

std::string rpe_interval_text(const FigureInput& input) {
  std::string unit;
  for (const auto& [value, name] : enum_names(input.rpe_unit)) {
    if (value == input.rpe_unit) unit = name;
  }
  if (input.rpe_unit == eval::RpeUnit::kFrames) unit = input.rpe_delta == 1.0 ? "pose" : "poses";
  return fmt::format("over {:g} {}", input.rpe_delta, unit);
}

Chart error_chart(const FigureInput& input, const FigureSize& size) {
  Chart chart = stacked_chart(input, &eval::Evaluation::ate_m, "m");
  const ErrorPlaces places(input, input.error_axis.value_or(ErrorAxis::kTime));
  const ErrorsOfRuns positions = errors_of_poses(input, &eval::PoseError::translation_m);
  add_errors(chart, positions, places, "position error [m]");
  if (has_rotation_errors(input)) {
    add_errors(chart, errors_of_poses(input, &eval::PoseError::rotation_deg), places, "rotation error [deg]");
  }
  if (!input.error_axis)
    add_errors(chart, positions, ErrorPlaces(input, ErrorAxis::kDistance), "position error [m]");
  return finished(std::move(chart), input, size);
}

Chart relative_chart(const FigureInput& input, const FigureSize& size) {
  const std::vector<RelativeSeries> all = all_relative_series(input);
  const ErrorsOfRuns distances = errors_in(all, &RelativeSeries::distance_m);
  if (are_empty(distances)) {
    throw InputError("--figure relative", "no estimate has two poses with ground truth that are " +
                                              rpe_interval_text(input).substr(5) +
                                              " apart; set another interval with --rpe-delta");
  }
  const ErrorsOfRuns positions = errors_in(all, &RelativeSeries::position_m);
  Chart chart = chart_of_errors(input, are_empty(positions) ? distances : positions, " [m]");
  const ErrorPlaces places(input, input.error_axis.value_or(ErrorAxis::kTime));
  add_errors(chart, positions, places, "position error [m]");
  add_errors(chart, errors_in(all, &RelativeSeries::rotation_deg), places, "rotation error [deg]");
  add_errors(chart, distances, places, "distance error [m]");
  chart.note = "Errors " + rpe_interval_text(input) +
               ", at the later pose; of the distance: between the positions of both poses.";
  return finished(std::move(chart), input, size);
}

Chart transform_chart(const FigureInput& input, const FigureSize& size) {
  require_rotations(input, "transform");
  const ErrorsOfRuns absolute = whole_errors_of_poses(input);
  Chart chart = chart_of_errors(input, absolute, "");
  const ErrorPlaces places(input, input.error_axis.value_or(ErrorAxis::kTime));
  add_errors(chart, absolute, places, "absolute error");
  add_errors(chart, errors_in(all_relative_series(input), &RelativeSeries::transform), places,
             "relative error");
  chart.note = "Frobenius norm of the error of the whole transformation minus the identity; relative: " +
               rpe_interval_text(input) + ", at the later pose.";
  return finished(std::move(chart), input, size);
}

}  // namespace stillpoint::report
