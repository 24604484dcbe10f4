// SPDX-License-Identifier: BSD-3-Clause
/// Charts for publications: panels below each other with ticks at round numbers, grid, axis titles, a legend
/// with numbers, a color bar and a scale bar. All lengths are in points (1/72 inch); the look is that of
/// theme.h.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reports/drawing/drawing.h"
#include "reports/drawing/theme.h"

namespace stillpoint::report {

/// Interval of values, empty until one is added.
struct ValueRange {
  double low = 1.0;
  double high = 0.0;

  [[nodiscard]] bool empty() const { return high < low; }
  [[nodiscard]] double length() const { return high - low; }
  void add(double value);
};

/// `range` extended at both ends by a fraction of its length; [-0.5, 0.5] around a single value and [0, 1]
/// without one.
[[nodiscard]] ValueRange padded(ValueRange range, double fraction);

/// Multiples of the smallest of ..., 1, 2, 5, 10, ... of which at most `most` are in the range.
struct Ticks {
  std::vector<double> values;
  double step = 1.0;
};
[[nodiscard]] Ticks nice_ticks(const ValueRange& range, std::size_t most);

/// The value with as many decimals as the step of the ticks has, and a minus sign instead of a hyphen.
[[nodiscard]] std::string tick_text(double value, double step);

/// `value` with three significant digits.
[[nodiscard]] std::string short_number(double value);

/// Length of a scale bar: the largest of 1, 2, 5, 10, ... [m] that is at most a third of `width_m`.
[[nodiscard]] double scale_bar_m(double width_m);

/// An axis. A step above 0 replaces that of `nice_ticks`. Named ticks replace those at round numbers and have
/// no grid lines.
struct ChartAxis {
  ValueRange range;
  std::string title;
  std::vector<std::pair<double, std::string>> named_ticks = {};
  double step = 0.0;
};

/// Plot area in the drawing, and its maps from values.
struct PlotArea {
  Point2 top_left;
  Point2 bottom_right;
  ValueRange x;
  ValueRange y;

  [[nodiscard]] Point2 at(double value_x, double value_y) const;
};

/// One plot area. Its contents are drawn over the grid.
struct ChartPanel {
  ChartAxis x;
  ChartAxis y;
  double height = 0.0;          ///< 0: both axes have the same scale
  bool shares_x_below = false;  ///< the next panel has the same x axis, which has no texts here
  bool has_axes = true;         ///< with ticks, grid and frame; else `draw` draws its own
  std::function<void(Drawing&, const PlotArea&)> draw = {};
};

/// A row of the legend: sample of the line or area, name, and numbers below the legend's heads. A name that
/// is too long is shortened.
struct LegendRow {
  theme::LineStyle style;
  double width = theme::kEstimateWidth;
  std::string name;
  std::vector<std::string> numbers;
  bool is_area = false;  ///< the sample is a filled area instead of a line
};

/// Scale of the colors of `theme::kErrorColors`; values beyond its ends have the colors of the ends.
struct ColorBar {
  double least = 0.0;
  double most = 1.0;
  std::string title;
};

struct Chart {
  std::string title;  ///< of the document, not drawn
  std::vector<ChartPanel> panels;
  std::vector<std::string> legend_heads = {};
  std::vector<LegendRow> legend = {};
  bool start_and_end = false;  ///< explains their marks in the legend
  std::optional<ColorBar> color_bar = std::nullopt;
  std::string note = {};  ///< text at the bottom, in as many lines as it needs
};

/// Size of a figure.
struct FigureSize {
  double width_mm = theme::kColumnWidthMm;
  double font_size_pt = theme::kFontSizePt;
};

[[nodiscard]] Drawing draw_chart(const Chart& chart, const FigureSize& size);

/// The color of an error in a color bar that ends at `most`.
[[nodiscard]] Color error_color(double error, double most);

/// A line in a style.
[[nodiscard]] Polyline styled_line(std::vector<Point2> points, const theme::LineStyle& style, double width);

/// Marks of the first (a disc) and the last pose (a square) of a path, with a white border.
[[nodiscard]] std::vector<Mark> start_mark(const Point2& at, const Color& color);
[[nodiscard]] std::vector<Mark> end_mark(const Point2& at, const Color& color);

}  // namespace stillpoint::report
