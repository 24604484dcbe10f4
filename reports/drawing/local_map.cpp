// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/local_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "eval/io/nmea_file.h"
#include "reports/drawing/style.h"

namespace stillpoint::report {
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
