// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/trajectory_plot.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "reports/drawing/style.h"

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

}  // namespace stillpoint::report
