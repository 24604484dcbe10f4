// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/trajectory_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "eval/io/nmea_file.h"

namespace stillpoint::report {
namespace {

constexpr double kPathHeight = 560.0;
constexpr double kErrorHeight = 240.0;
constexpr std::size_t kMaxPoints = 2000;  // per line; more than a plot can resolve

/// Linear map from data to drawing coordinates.
struct Axis {
  double low = 0.0;
  double scale = 1.0;
  double origin = 0.0;

  [[nodiscard]] double operator()(double value) const { return origin + scale * (value - low); }
};

std::vector<Eigen::Vector3d> thinned_positions(const Trajectory& path, const eval::Similarity& S_w_v) {
  const std::size_t step = path.poses.size() / kMaxPoints + 1;
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < path.poses.size(); i += step)
    positions.push_back(S_w_v * path.poses[i].T_w_f.p);
  return positions;
}

/// Smallest box around positions.
struct Bounds {
  Eigen::Vector3d low;
  Eigen::Vector3d high;

  explicit Bounds(const std::vector<Eigen::Vector3d>& positions)
      : low(positions.front()), high(positions.front()) {
    add(positions);
  }
  void add(const std::vector<Eigen::Vector3d>& positions) {
    for (const Eigen::Vector3d& p : positions) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
};

void draw_paths(Drawing& drawing, const Trajectory& gt, const std::vector<PlottedRun>& runs) {
  const std::vector<Eigen::Vector3d> truth = thinned_positions(gt, {});
  Bounds bounds(truth);
  const Eigen::Vector3d extent = bounds.high - bounds.low;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return extent(a) > extent(b); });
  std::vector<std::vector<Eigen::Vector3d>> estimates;
  for (const PlottedRun& run : runs) {
    estimates.push_back(thinned_positions(*run.est, run.evaluation->alignment.S_w_v));
    bounds.add(estimates.back());
  }
  const Eigen::Vector3d shown = bounds.high - bounds.low;
  const double scale = std::min((kPlotWidth - 2.0 * kPlotMargin) / std::max(shown(order[0]), 1e-3),
                                (kPathHeight - 2.0 * kPlotMargin) / std::max(shown(order[1]), 1e-3));
  const Axis across{bounds.low(order[0]), scale, kPlotMargin};
  const Axis up{bounds.low(order[1]), -scale, kPathHeight - kPlotMargin};
  const auto draw = [&](const std::vector<Eigen::Vector3d>& positions, Color color) {
    Polyline line{{}, color, 2.0};
    for (const Eigen::Vector3d& p : positions) line.points.push_back({across(p(order[0])), up(p(order[1]))});
    drawing.marks.push_back(line);
  };
  draw(truth, kBlack);
  for (std::size_t i = 0; i < estimates.size(); ++i) draw(estimates[i], kLineColors[i % kLineColors.size()]);
  constexpr std::array<char, 3> kNames{'x', 'y', 'z'};
  drawing.marks.push_back(
      Label{{kPlotMargin, kPathHeight - 20.0},
            fmt::format("{} to the right, {} up; the ground truth spans {:.2f} x {:.2f} m",
                        kNames[static_cast<std::size_t>(order[0])],
                        kNames[static_cast<std::size_t>(order[1])], extent(order[0]), extent(order[1])),
            16.0,
            Anchor::kLeft,
            kBlack});
}

void draw_errors(Drawing& drawing, const Trajectory& gt, const std::vector<PlottedRun>& runs) {
  const Timestamp start = gt.poses.front().t;
  const double duration_s = std::max(seconds_between(start, gt.poses.back().t), 1e-3);
  double highest = 1e-6;
  for (const PlottedRun& run : runs) {
    for (const eval::PoseError& error : run.evaluation->per_pose)
      highest = std::max(highest, error.translation_m);
  }
  const double bottom = kPathHeight + kErrorHeight - 40.0;
  const Axis time{0.0, (kPlotWidth - 2.0 * kPlotMargin) / duration_s, kPlotMargin};
  const Axis up{0.0, -(kErrorHeight - 70.0) / highest, bottom};
  drawing.marks.push_back(Polyline{{{kPlotMargin, bottom}, {kPlotWidth - kPlotMargin, bottom}}, kGray, 1.5});
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::vector<eval::PoseError>& errors = runs[i].evaluation->per_pose;
    Polyline line{{}, kLineColors[i % kLineColors.size()], 1.5};
    for (std::size_t k = 0; k < errors.size(); k += errors.size() / kMaxPoints + 1) {
      line.points.push_back({time(seconds_between(start, errors[k].t)), up(errors[k].translation_m)});
    }
    if (!line.points.empty()) drawing.marks.push_back(line);
  }
  drawing.marks.push_back(
      Label{{kPlotMargin, bottom + 24.0},
            fmt::format("position error over {:.1f} s, at most {:.3f} m", duration_s, highest),
            16.0,
            Anchor::kLeft,
            kBlack});
}

}  // namespace

Drawing trajectory_plot(const Trajectory& gt, const std::vector<PlottedRun>& runs) {
  Drawing drawing{kPlotWidth, kPathHeight + kErrorHeight, {}};
  if (gt.poses.empty()) return drawing;
  draw_paths(drawing, gt, runs);
  draw_errors(drawing, gt, runs);
  double y = 24.0;
  drawing.marks.push_back(Label{{kPlotMargin, y}, "ground truth", 16.0, Anchor::kLeft, kBlack});
  for (std::size_t i = 0; i < runs.size(); ++i) {
    drawing.marks.push_back(Label{{kPlotWidth - kPlotMargin, y},
                                  runs[i].name,
                                  16.0,
                                  Anchor::kRight,
                                  kLineColors[i % kLineColors.size()]});
    y += 20.0;
  }
  return drawing;
}

namespace {

constexpr double kMapMargin = 70.0;
constexpr std::size_t kMaxMapPoints = 4000;  // per line
constexpr double kMinExtentM = 1e-3;

/// Positions in the plane [m].
using MapLine = std::vector<Eigen::Vector2d>;

MapLine map_line(const Trajectory& path, const eval::Similarity& S_w_v) {
  const std::size_t step = path.poses.size() / kMaxMapPoints + 1;
  MapLine line;
  for (std::size_t i = 0; i < path.poses.size(); i += step)
    line.push_back((S_w_v * path.poses[i].T_w_f.p).head<2>());
  return line;
}

/// Linear map from meters to the drawing.
struct MapFrame {
  Eigen::Vector2d low{0.0, 0.0};
  double units_per_m = 1.0;
  double height = kPlotWidth;

  [[nodiscard]] Point2 at(const Eigen::Vector2d& p) const {
    return {kMapMargin + units_per_m * (p.x() - low.x()),
            height - kMapMargin - units_per_m * (p.y() - low.y())};
  }
};

MapFrame frame_of(const std::vector<MapLine>& lines) {
  Eigen::Vector2d low = lines.front().front();
  Eigen::Vector2d high = low;
  for (const MapLine& line : lines) {
    for (const Eigen::Vector2d& p : line) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const double extent_m = std::max((high - low).maxCoeff(), kMinExtentM);
  MapFrame frame{.low = low, .units_per_m = (kPlotWidth - 2.0 * kMapMargin) / extent_m};
  frame.height = 2.0 * kMapMargin + frame.units_per_m * (high - low).y();
  return frame;
}

void draw_scale_bar(Drawing& drawing, const MapFrame& frame) {
  const double length_m = scale_bar_m((kPlotWidth - 2.0 * kMapMargin) / frame.units_per_m);
  const double y = drawing.height - 24.0;
  const double end = kMapMargin + length_m * frame.units_per_m;
  drawing.marks.push_back(
      Polyline{{{kMapMargin, y - 5.0}, {kMapMargin, y}, {end, y}, {end, y - 5.0}}, kBlack, 2.0});
  drawing.marks.push_back(
      Label{{end + 8.0, y + 4.0}, fmt::format("{:g} m", length_m), 16.0, Anchor::kLeft, kBlack});
}

void draw_arrow(Drawing& drawing, const std::string& name) {
  const double x = drawing.width - 30.0;
  drawing.marks.push_back(Polyline{{{x, 70.0}, {x, 28.0}}, kBlack, 2.0});
  drawing.marks.push_back(Polyline{{{x - 6.0, 40.0}, {x, 28.0}, {x + 6.0, 40.0}}, kBlack, 2.0});
  drawing.marks.push_back(Label{{x, 22.0}, name, 16.0, Anchor::kMiddle, kBlack});
}

}  // namespace

double scale_bar_m(double width_m) {
  const double limit = width_m / 3.0;
  const double decade = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= limit) return factor * decade;
  }
  return decade;
}

Drawing local_map(const Trajectory& gt, const std::vector<PlottedRun>& runs) {
  if (gt.poses.empty()) return {kPlotWidth, kPlotWidth, {}};
  std::vector<MapLine> lines{map_line(gt, {})};
  for (const PlottedRun& run : runs) {
    if (!run.est->poses.empty()) lines.push_back(map_line(*run.est, run.evaluation->alignment.S_w_v));
  }
  const MapFrame frame = frame_of(lines);
  const double legend_height = 24.0 + 20.0 * static_cast<double>(runs.size());
  Drawing drawing{kPlotWidth, std::max(frame.height, 2.0 * kMapMargin + legend_height), {}};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    Polyline drawn{{}, i == 0 ? kBlack : kLineColors[(i - 1) % kLineColors.size()], 2.0};
    for (const Eigen::Vector2d& p : lines[i]) drawn.points.push_back(frame.at(p));
    drawing.marks.push_back(drawn);
  }
  drawing.marks.push_back(Disc{frame.at(lines.front().front()), 4.0, kBlack});
  const bool is_gnss = gt.frame == eval::kGnssFrame;
  draw_scale_bar(drawing, frame);
  draw_arrow(drawing, is_gnss ? "N" : "y");
  drawing.marks.push_back(
      Label{{kMapMargin, 24.0}, is_gnss ? "GNSS" : "ground truth", 16.0, Anchor::kLeft, kBlack});
  for (std::size_t i = 0; i < runs.size(); ++i) {
    drawing.marks.push_back(Label{{kMapMargin, 44.0 + 20.0 * static_cast<double>(i)},
                                  runs[i].name,
                                  16.0,
                                  Anchor::kLeft,
                                  kLineColors[i % kLineColors.size()]});
  }
  return drawing;
}

}  // namespace stillpoint::report
