// SPDX-License-Identifier: BSD-3-Clause
// Histograms of errors, and bars of their statistics.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "eval/metrics/statistics.h"
#include "reports/drawing/evaluation/figure_parts.h"

namespace stillpoint::report {
namespace {

constexpr double kStatisticsPanelRatio = 0.36;  // height per width of the figure

/// Finite errors of each run in one panel.
struct PanelErrors {
  std::vector<std::vector<double>> runs;
  std::string title;
  double most = 0.0;
};

/// Position errors, and rotation errors if there are any.
std::vector<PanelErrors> errors_of_runs(const FigureInput& input) {
  std::vector<PanelErrors> panels;
  const auto add = [&](double eval::PoseError::*error, const char* title) {
    PanelErrors panel{.runs = {}, .title = title};
    for (const PlottedRun& run : input.runs) {
      std::vector<double>& values = panel.runs.emplace_back();
      for (const eval::PoseError& pose : run.evaluation->per_pose) {
        if (!std::isfinite(pose.*error)) continue;
        values.push_back(pose.*error);
        panel.most = std::max(panel.most, values.back());
      }
    }
    if (std::ranges::any_of(panel.runs, [](const auto& values) { return !values.empty(); }))
      panels.push_back(std::move(panel));
  };
  add(&eval::PoseError::translation_m, "position error [m]");
  add(&eval::PoseError::rotation_deg, "rotation error [deg]");
  return panels;
}

Chart statistics_chart(const FigureInput& input) {
  Chart chart{.title = {}, .panels = {}, .legend = legend_rows(input, &eval::Evaluation::ate_m)};
  chart.legend.erase(chart.legend.begin());  // the ground truth has no error
  chart.legend_heads = {"RMSE [m]", "median", "max", "n"};
  return chart;
}

/// Outline of the numbers of values in bins of one width from 0.
Curve histogram_outline(const std::vector<double>& values, double width, std::size_t bins) {
  std::vector<double> counts(bins, 0.0);
  for (const double value : values)
    ++counts[std::min(static_cast<std::size_t>(std::floor(value / width)), bins - 1)];
  std::vector<CurvePoint> line{{0.0, {0.0, 0.0}}};
  for (std::size_t k = 0; k < bins; ++k) {
    line.push_back({0.0, {width * static_cast<double>(k), counts[k]}});
    line.push_back({0.0, {width * static_cast<double>(k + 1), counts[k]}});
  }
  line.push_back({0.0, {width * static_cast<double>(bins), 0.0}});
  return {line};
}

struct StatisticValue {
  const char* name;
  double eval::Statistics::*value;
};
constexpr std::array<StatisticValue, 6> kBars{{{"RMSE", &eval::Statistics::rmse},
                                               {"mean", &eval::Statistics::mean},
                                               {"median", &eval::Statistics::median},
                                               {"std", &eval::Statistics::std},
                                               {"min", &eval::Statistics::min},
                                               {"max", &eval::Statistics::max}}};

/// A group of bars for each statistic, a bar for each run.
ChartPanel bars_panel(const PanelErrors& errors, const std::vector<LegendRow>& rows, double height) {
  ChartPanel panel{.x = {{-0.6, kBars.size() - 0.4}, ""},
                   .y = {{0.0, errors.most > 0.0 ? 1.05 * errors.most : 1.0}, errors.title},
                   .height = height};
  for (std::size_t k = 0; k < kBars.size(); ++k)
    panel.x.named_ticks.emplace_back(static_cast<double>(k), kBars[k].name);
  std::vector<std::optional<eval::Statistics>> statistics;
  for (const std::vector<double>& values : errors.runs) statistics.push_back(eval::statistics(values));
  panel.draw = [statistics = std::move(statistics), rows](Drawing& drawing, const PlotArea& area) {
    const double width = 0.8 / static_cast<double>(statistics.size());
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      for (std::size_t k = 0; statistics[i] && k < kBars.size(); ++k) {
        const double left = static_cast<double>(k) - 0.4 + width * static_cast<double>(i);
        const double right = left + 0.92 * width;
        const double value = *statistics[i].*kBars[k].value;
        drawing.marks.push_back(
            Polygon{{area.at(left, 0.0), area.at(left, value), area.at(right, value), area.at(right, 0.0)},
                    rows[i].style.color});
      }
    }
  };
  return panel;
}

double height_of(const FigureSize& size) { return kStatisticsPanelRatio * size.width_mm * 72.0 / 25.4; }

}  // namespace

void add_statistics(ChartPanel& panel, const Curve& curve) {
  std::vector<double> values;
  for (const std::vector<CurvePoint>& line : curve) {
    for (const CurvePoint& point : line) values.push_back(point.at.y);
  }
  const auto found = eval::statistics(values);
  if (!found) return;
  panel.draw = [s = *found, contents = panel.draw](Drawing& drawing, const PlotArea& area) {
    const auto line = [&](double y) {
      return std::vector<Point2>{area.at(area.x.low, y), area.at(area.x.high, y)};
    };
    std::vector<Point2> band = line(std::max(0.0, s.mean - s.std));
    const std::vector<Point2> top = line(std::min(area.y.high, s.mean + s.std));
    band.insert(band.end(), top.rbegin(), top.rend());
    drawing.marks.push_back(Polygon{band, theme::kGrid});
    contents(drawing, area);
    drawing.marks.push_back(styled_line(line(s.mean), theme::kMean, theme::kEstimateWidth));
    drawing.marks.push_back(styled_line(line(s.median), theme::kMedian, theme::kEstimateWidth));
  };
}

Chart histogram_chart(const FigureInput& input, const FigureSize& size) {
  constexpr std::size_t kMostBins = 25;
  Chart chart = statistics_chart(input);
  for (const PanelErrors& errors : errors_of_runs(input)) {
    const double width = errors.most > 0.0 ? nice_ticks({0.0, errors.most}, kMostBins).step : 1.0;
    const auto bins = static_cast<std::size_t>(std::floor(errors.most / width)) + 1;
    std::vector<Curve> outlines;
    double highest = 1.0;
    for (const std::vector<double>& values : errors.runs) {
      outlines.push_back(histogram_outline(values, width, bins));
      for (const CurvePoint& point : outlines.back().front()) highest = std::max(highest, point.at.y);
    }
    ChartPanel panel{.x = {{0.0, width * static_cast<double>(bins)}, errors.title},
                     .y = {{0.0, 1.05 * highest}, "number of poses"},
                     .height = height_of(size)};
    panel.draw = [outlines = std::move(outlines), rows = chart.legend](Drawing& drawing,
                                                                       const PlotArea& area) {
      for (std::size_t i = 0; i < outlines.size(); ++i) draw_curve(drawing, area, outlines[i], rows[i]);
    };
    chart.panels.push_back(std::move(panel));
  }
  return chart;
}

Chart bars_chart(const FigureInput& input, const FigureSize& size) {
  Chart chart = statistics_chart(input);
  fill_samples(chart);
  for (const PanelErrors& errors : errors_of_runs(input))
    chart.panels.push_back(bars_panel(errors, chart.legend, height_of(size)));
  return chart;
}

}  // namespace stillpoint::report
