// SPDX-License-Identifier: BSD-3-Clause
/// Figures of an evaluation for publications: paths, coordinates, rotations, errors and speeds of several
/// estimates with the ground truth, which is dashed and drawn above them. Where poses are missing, lines have
/// gaps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/fields.h"
#include "core/types/trajectory.h"
#include "datasets/mapping/map_window.h"
#include "eval/protocols/protocol.h"
#include "reports/drawing/chart.h"
#include "reports/drawing/curves.h"

namespace stillpoint::report {

enum class FigureKind {
  kPath,
  kAxes,
  kRotation,
  kError,
  kRelative,
  kTransform,
  kRpe,
  kBox,
  kCdf,
  kHistogram,
  kBars,
  kSpeed
};
constexpr auto enum_names(FigureKind) {
  return EnumNames<FigureKind, 12>{{{FigureKind::kPath, "path"},
                                    {FigureKind::kAxes, "axes"},
                                    {FigureKind::kRotation, "rotation"},
                                    {FigureKind::kError, "error"},
                                    {FigureKind::kRelative, "relative"},
                                    {FigureKind::kTransform, "transform"},
                                    {FigureKind::kRpe, "rpe"},
                                    {FigureKind::kBox, "box"},
                                    {FigureKind::kCdf, "cdf"},
                                    {FigureKind::kHistogram, "histogram"},
                                    {FigureKind::kBars, "bars"},
                                    {FigureKind::kSpeed, "speed"}}};
}

/// One estimated trajectory and its evaluation.
struct PlottedRun {
  std::string name;
  const Trajectory* est = nullptr;
  const eval::Evaluation* evaluation = nullptr;  ///< with errors per pose
};

/// Axes of `path` to the right and up, or an orthographic view in 3-D, named as evo's plot modes.
enum class PlotMode { kXy, kXz, kYx, kYz, kZx, kZy, kXyz };
constexpr auto enum_names(PlotMode) {
  return EnumNames<PlotMode, 7>{{{PlotMode::kXy, "xy"},
                                 {PlotMode::kXz, "xz"},
                                 {PlotMode::kYx, "yx"},
                                 {PlotMode::kYz, "yz"},
                                 {PlotMode::kZx, "zx"},
                                 {PlotMode::kZy, "zy"},
                                 {PlotMode::kXyz, "xyz"}}};
}

/// What errors are drawn over. The index is that of a pose in its file, from 0.
enum class ErrorAxis { kTime, kIndex, kDistance };
constexpr auto enum_names(ErrorAxis) {
  return EnumNames<ErrorAxis, 3>{
      {{ErrorAxis::kTime, "time"}, {ErrorAxis::kIndex, "index"}, {ErrorAxis::kDistance, "distance"}}};
}

/// The error that colors the path of a single estimate; relative: of positions, over
/// `FigureInput::rpe_delta`.
enum class PathColor { kPosition, kRotation, kRelative };
constexpr auto enum_names(PathColor) {
  return EnumNames<PathColor, 3>{{{PathColor::kPosition, "position"},
                                  {PathColor::kRotation, "rotation"},
                                  {PathColor::kRelative, "relative"}}};
}

struct PathOptions {
  std::optional<PlotMode> mode;  ///< none: plan and side view in which the ground truth is longest
  PathColor color = PathColor::kPosition;
  double least_error = 0.0;          ///< limits of the color bar of a single estimate
  std::optional<double> most_error;  ///< none: the largest error, or its percentile
  double most_percentile = 100.0;    ///< of the errors, for the upper limit
  bool pose_axes = false;            ///< of about 20 poses of each path
  bool correspondences = false;      ///< lines from poses to the ground truth at their times
  /// Map below the paths in the plane of x and y, in the world of the ground truth; at half of its contrast.
  datasets::MapSource map = {};
  std::string map_credit = {};  ///< who made the map; at the border of the figure
};

struct FigureInput {
  const Trajectory& gt;  ///< not empty
  std::span<const PlottedRun> runs;
  double offset_s = 0.0;    ///< added to the stamps of the estimates
  double max_gap_s = 0.11;  ///< of ground truth that is interpolated for relative errors, to each neighbor
  PathOptions path = {};
  std::optional<ErrorAxis> error_axis = {};  ///< none: time, and distance for `error`
  double rpe_delta = 1.0;                    ///< of relative errors, in `rpe_unit`
  eval::RpeUnit rpe_unit = eval::RpeUnit::kSeconds;
};

/// The poses of an estimate in the world of the ground truth, with its offset: positions by the alignment of
/// the errors; where these leave the rotation open (`Evaluation::rotation_source`), orientations as
/// `eval::complete_rotation` finds them, as in the rotation errors.
[[nodiscard]] std::vector<TimedPose> aligned_poses(const FigureInput& input, const PlottedRun& run);

/// path: plan and side view, to scale; a single estimate is colored by its error. axes: x, y, z over time.
/// rotation: roll, pitch, yaw (R = Rz(yaw) Ry(pitch) Rx(roll)) over time. error: over time and distance.
/// relative: errors of position, rotation and distance relative to the pose `rpe_delta` before, over time
/// (pairs of `eval::strict_pairs`). transform: errors of whole transformations, absolute and relative. rpe:
/// relative errors over five lengths, the longest 20 to 50 % of the path, with 10 segments or more. box, cdf:
/// distribution of the errors, with their densities between the 5th and 95th percentile. histogram: numbers
/// of poses in bins of one width. bars: RMSE, mean, median, standard deviation, least and largest error.
/// speed: linear and angular, over 0.2 s. Legends have the numbers of the evaluations.
/// @throws InputError naming the figure if no estimate has data for it
[[nodiscard]] Drawing figure(FigureKind kind, const FigureInput& input, const FigureSize& size);

/// x of the ground truth to the right and y up, to scale, with an arrow: east and north if the ground truth
/// is that of a GNSS receiver (eval/io/nmea_file.h).
[[nodiscard]] Drawing plan_map(const FigureInput& input, const FigureSize& size);

/// Rows of the legend: the ground truth, and each estimate with the statistics of its error.
/// @param errors of each run; empty: without numbers
[[nodiscard]] std::vector<LegendRow> legend_rows(const FigureInput& input,
                                                 std::span<const std::optional<eval::Statistics>> errors);

/// The same with an error of the evaluations; null: without numbers.
[[nodiscard]] std::vector<LegendRow> legend_rows(const FigureInput& input,
                                                 std::optional<eval::Statistics> eval::Evaluation::*error);

/// Errors of the poses of a run with their times [s] since the first pose of the ground truth.
[[nodiscard]] std::vector<CurvePoint> error_points(const FigureInput& input, const PlottedRun& run,
                                                   double eval::PoseError::*error);

/// Errors relative to an earlier pose, at the times of the later one.
struct RelativeSeries {
  std::vector<CurvePoint> position_m;  ///< empty, as the next two, if orientations cannot be compared
  std::vector<CurvePoint> rotation_deg;
  std::vector<CurvePoint> transform;
  std::vector<CurvePoint> distance_m;  ///< between the two positions
};
[[nodiscard]] RelativeSeries relative_series(const FigureInput& input, const PlottedRun& run);

/// Of the finite errors; nullopt without any.
[[nodiscard]] std::optional<eval::Statistics> statistics_of(std::span<const CurvePoint> points);

/// "over 1 s"
[[nodiscard]] std::string rpe_interval_text(const FigureInput& input);

/// Adds the mean and the median of the errors of a single run to its panel, above a band of one standard
/// deviation around the mean.
/// @param curve of the errors; without points, nothing is added
void add_statistics(ChartPanel& panel, const Curve& curve);

/// The charts of `FigureKind::kHistogram` and `FigureKind::kBars`.
[[nodiscard]] Chart histogram_chart(const FigureInput& input, const FigureSize& size);
[[nodiscard]] Chart bars_chart(const FigureInput& input, const FigureSize& size);

/// The charts of `FigureKind::kError`, `kRelative` and `kTransform`.
[[nodiscard]] Chart error_chart(const FigureInput& input, const FigureSize& size);
[[nodiscard]] Chart relative_chart(const FigureInput& input, const FigureSize& size);
[[nodiscard]] Chart transform_chart(const FigureInput& input, const FigureSize& size);

/// The chart of `FigureKind::kPath`.
/// @param input must outlive the chart, as its panels refer to it
/// @throws InputError if the lower limit of the color bar is not below the upper one
[[nodiscard]] Chart path_chart(const FigureInput& input, const FigureSize& size);

}  // namespace stillpoint::report
