// SPDX-License-Identifier: BSD-3-Clause
/// Parts that charts of evaluations share.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "reports/drawing/evaluation/figures.h"

namespace stillpoint::report {

using ErrorStatistics = std::optional<eval::Statistics> eval::Evaluation::*;

/// Height of a panel over time, per width of the figure.
inline constexpr double kPanelRatio = 0.24;

inline double panel_height(const FigureSize& size) { return kPanelRatio * size.width_mm * 72.0 / 25.4; }

inline bool has_rotation_errors(const FigureInput& input) {
  return std::ranges::any_of(input.runs,
                             [](const PlottedRun& run) { return run.evaluation->ate_deg.has_value(); });
}

inline void require_rotations(const FigureInput& input, const char* kind) {
  if (has_rotation_errors(input)) return;
  throw InputError(std::string("--figure ") + kind,
                   "the orientations of no estimate can be compared with those of the ground truth");
}

/// Curves of the truth (first) and of the estimates in one panel.
using Curves = std::vector<Curve>;

inline ValueRange y_range(const Curves& curves) {
  ValueRange range;
  for (const Curve& curve : curves) {
    for (const std::vector<CurvePoint>& line : curve) {
      for (const CurvePoint& point : line) range.add(point.at.y);
    }
  }
  return range;
}

inline ValueRange from_zero(const ValueRange& range) {
  return {0.0, range.empty() || range.high <= 0.0 ? 1.0 : 1.05 * range.high};
}

/// From the first pose of the truth; estimates may begin earlier and end later.
inline ValueRange duration(const FigureInput& input) {
  const Timestamp start = input.gt.poses.front().t;
  ValueRange range{0.0, std::max(seconds_between(start, input.gt.poses.back().t), 1e-3)};
  for (const PlottedRun& run : input.runs) {
    if (run.est->poses.empty()) continue;
    range.add(seconds_between(start, run.est->poses.front().t) + input.offset_s);
    range.add(seconds_between(start, run.est->poses.back().t) + input.offset_s);
  }
  return range;
}

/// Rows of the estimates first, the truth last: above them.
inline std::function<void(Drawing&, const PlotArea&)> drawing_of(Curves curves, std::vector<LegendRow> rows) {
  return [curves = std::move(curves), rows = std::move(rows)](Drawing& drawing, const PlotArea& area) {
    for (std::size_t i = 1; i < curves.size(); ++i) draw_curve(drawing, area, curves[i], rows[i]);
    draw_curve(drawing, area, curves.front(), rows.front());
  };
}

/// Panels below each other with the same x axis.
inline Chart stacked_chart(const FigureInput& input, ErrorStatistics error, const char* unit) {
  Chart chart{.title = {}, .panels = {}};
  chart.legend = legend_rows(input, error);
  chart.legend_heads = {std::string("RMSE [") + unit + "]", "median", "max", "n"};
  return chart;
}

inline void share_x(Chart& chart) {
  for (std::size_t i = 0; i + 1 < chart.panels.size(); ++i) chart.panels[i].shares_x_below = true;
}

/// The legend without the ground truth, which has no error.
inline void drop_truth(Chart& chart) { chart.legend.erase(chart.legend.begin()); }

/// Samples of the legend as areas, for charts without lines.
inline void fill_samples(Chart& chart) {
  for (LegendRow& row : chart.legend) row.is_area = true;
}

/// Path length of the ground truth up to a time [s since its first pose], linear between its poses.
class TraveledDistance {
 public:
  explicit TraveledDistance(const Trajectory& gt) {
    for (const StampedPose& pose : gt.poses) {
      if (!meters_.empty()) meters_.push_back(meters_.back() + (pose.T_w_f.p - previous_).norm());
      if (meters_.empty()) meters_.push_back(0.0);
      times_s_.push_back(seconds_between(gt.poses.front().t, pose.t));
      previous_ = pose.T_w_f.p;
    }
  }

  [[nodiscard]] double total_m() const { return meters_.back(); }
  [[nodiscard]] double at(double t_s) const {
    const auto later = std::ranges::upper_bound(times_s_, t_s);
    if (later == times_s_.begin()) return 0.0;
    if (later == times_s_.end()) return meters_.back();
    const auto i = static_cast<std::size_t>(later - times_s_.begin());
    const double weight = (t_s - times_s_[i - 1]) / (times_s_[i] - times_s_[i - 1]);
    return meters_[i - 1] + weight * (meters_[i] - meters_[i - 1]);
  }

 private:
  std::vector<double> times_s_;
  std::vector<double> meters_;
  Eigen::Vector3d previous_ = Eigen::Vector3d::Zero();
};

}  // namespace stillpoint::report
