// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/chart.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace stillpoint::report {

void ValueRange::add(double value) {
  if (!std::isfinite(value)) return;
  const bool first = empty();
  low = first ? value : std::min(low, value);
  high = first ? value : std::max(high, value);
}

ValueRange padded(ValueRange range, double fraction) {
  if (range.empty()) return {0.0, 1.0};
  if (range.length() < 1e-12) return {range.low - 0.5, range.high + 0.5};
  const double pad = fraction * range.length();
  return {range.low - pad, range.high + pad};
}

namespace {

constexpr double kTickTolerance = 1e-9;  // of a step: a tick at the end of the range is inside

double first_multiple(const ValueRange& range, double step) {
  return std::ceil(range.low / step - kTickTolerance);
}
double last_multiple(const ValueRange& range, double step) {
  return std::floor(range.high / step + kTickTolerance);
}

Ticks multiples_in(const ValueRange& range, double step) {
  Ticks ticks{.values = {}, .step = step};
  for (double k = first_multiple(range, step); k <= last_multiple(range, step); ++k)
    ticks.values.push_back(k * step);
  return ticks;
}

}  // namespace

Ticks nice_ticks(const ValueRange& range, std::size_t most) {
  const double finest = range.length() / static_cast<double>(std::max<std::size_t>(most, 1));
  for (double decade = std::pow(10.0, std::floor(std::log10(finest)));; decade *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double step = factor * decade;
      const double count = last_multiple(range, step) - first_multiple(range, step) + 1.0;
      if (count <= static_cast<double>(most)) return multiples_in(range, step);
    }
  }
}

std::string tick_text(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const std::string text = fmt::format("{:.{}f}", std::abs(value), std::min(decimals, 9));
  return value < -0.5 * step ? "\u2212" + text : text;
}

std::string short_number(double value) {
  if (!std::isfinite(value)) return "n/a";
  const double size = std::abs(value);
  const int decimals = size > 0.0 ? std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6) : 0;
  return fmt::format("{:.{}f}", value, decimals);
}

double scale_bar_m(double width_m) {
  const double limit = width_m / 3.0;
  const double decade = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= limit) return factor * decade;
  }
  return decade;
}

Point2 PlotArea::at(double value_x, double value_y) const {
  return {top_left.x + (bottom_right.x - top_left.x) * (value_x - x.low) / x.length(),
          bottom_right.y - (bottom_right.y - top_left.y) * (value_y - y.low) / y.length()};
}

Color error_color(double error, double most) {
  const double last = static_cast<double>(theme::kErrorColors.size() - 1);
  const double place = most > 0.0 ? std::clamp(error / most, 0.0, 1.0) * last : 0.0;
  const std::size_t below = std::min(static_cast<std::size_t>(place), theme::kErrorColors.size() - 2);
  const double weight = place - static_cast<double>(below);
  const Color& a = theme::kErrorColors[below];
  const Color& b = theme::kErrorColors[below + 1];
  const auto mix = [&](int from, int to) {
    return static_cast<int>(std::lround(from + weight * (to - from)));
  };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

Polyline styled_line(std::vector<Point2> points, const theme::LineStyle& style, double width) {
  Polyline line{std::move(points), style.color, width};
  for (const double length : style.dashes) {
    if (length > 0.0) line.dashes.push_back(length);
  }
  return line;
}

namespace {

Polygon square(const Point2& center, double half, const Color& color) {
  return {{{center.x - half, center.y - half},
           {center.x + half, center.y - half},
           {center.x + half, center.y + half},
           {center.x - half, center.y + half}},
          color};
}

constexpr double kMarkBorder = 0.7;

}  // namespace

std::vector<Mark> start_mark(const Point2& at, const Color& color) {
  return {Disc{at, theme::kMarkRadius + kMarkBorder, theme::kWhite}, Disc{at, theme::kMarkRadius, color}};
}

std::vector<Mark> end_mark(const Point2& at, const Color& color) {
  return {square(at, theme::kMarkRadius + kMarkBorder, theme::kWhite), square(at, theme::kMarkRadius, color)};
}

namespace {

/// Lengths that follow from the size of the font.
struct ChartLayout {
  double width = 0.0;
  double font = 0.0;

  [[nodiscard]] double line_height() const { return 1.3 * font; }
  [[nodiscard]] double margin() const { return 0.3 * font; }
  /// Half of a tick text.
  [[nodiscard]] double right_margin() const { return 1.1 * font; }
  [[nodiscard]] double tick_gap() const { return theme::kTickLength + 0.3 * font; }
  /// Below a panel with texts.
  [[nodiscard]] double x_axis_height(bool has_title) const {
    return tick_gap() + font + (has_title ? 1.25 * font : 0.0);
  }
};

/// Text with the baseline that centers digits at `y`.
Label centered_label(const Point2& at, std::string text, double size, Anchor anchor) {
  constexpr double kHalfCapital = 0.36;  // of the font size
  return {{at.x, at.y + kHalfCapital * size}, std::move(text), size, anchor, theme::kBlack};
}

/// Numbers of ticks on an axis: as many as look well, and as many as do not touch.
struct TickLimits {
  std::size_t preferred = 2;
  std::size_t most = 2;
};

/// Two ticks hardly tell a scale: a finer step is taken if its ticks do not touch.
Ticks round_ticks(const ValueRange& range, const TickLimits& limits) {
  constexpr std::size_t kFewTicks = 3;
  Ticks ticks = nice_ticks(range, limits.preferred);
  for (std::size_t most = limits.preferred + 1; ticks.values.size() < kFewTicks && most <= limits.most;
       ++most)
    ticks = nice_ticks(range, most);
  return ticks;
}

std::vector<std::pair<double, std::string>> ticks_of(const ChartAxis& axis, const TickLimits& limits) {
  if (!axis.named_ticks.empty()) return axis.named_ticks;
  const Ticks ticks = axis.step > 0.0 ? multiples_in(axis.range, axis.step) : round_ticks(axis.range, limits);
  std::vector<std::pair<double, std::string>> named;
  for (const double value : ticks.values) named.emplace_back(value, tick_text(value, ticks.step));
  return named;
}

std::size_t most_ticks(double length, double spacing) {
  return static_cast<std::size_t>(std::clamp(length / spacing, 2.0, 12.0));
}

TickLimits y_tick_limits(const ChartLayout& layout, double height) {
  return {most_ticks(height, 2.2 * layout.font), most_ticks(height, 1.15 * layout.font)};
}

std::string shortened(const std::string& text, double size, double width) {
  if (text_width(text, size) <= width) return text;
  std::string shorter = text;
  while (!shorter.empty() && text_width(shorter + "\u2026", size) > width) {
    do {
      const bool inside_character = (static_cast<unsigned char>(shorter.back()) & 0xC0U) == 0x80U;
      shorter.pop_back();
      if (!inside_character) break;
    } while (!shorter.empty());
  }
  return shorter + "\u2026";
}

/// Between the left edge and the plot areas: tick texts and the title of the y axis.
double left_margin(const Chart& chart, const ChartLayout& layout) {
  if (std::ranges::none_of(chart.panels, &ChartPanel::has_axes)) return 2.0 * layout.right_margin();
  double texts = 0.0;
  bool has_title = false;
  for (const ChartPanel& panel : chart.panels) {
    if (!panel.has_axes) continue;
    const double height = panel.height > 0.0 ? panel.height : layout.width;
    for (const auto& [value, text] : ticks_of(panel.y, y_tick_limits(layout, height)))
      texts = std::max(texts, text_width(text, layout.font));
    has_title |= !panel.y.title.empty();
  }
  constexpr double kMostForNames = 0.3;  // of the width
  return std::min(texts, kMostForNames * layout.width) + layout.tick_gap() + layout.margin() +
         (has_title ? 1.25 * layout.font : 0.0);
}

void add_marks(Drawing& drawing, std::vector<Mark> marks) {
  for (Mark& mark : marks) drawing.marks.push_back(std::move(mark));
}

void draw_x_axis(Drawing& drawing, const ChartPanel& panel, const PlotArea& area, const ChartLayout& layout) {
  const double bottom = area.bottom_right.y;
  const bool has_texts = !panel.shares_x_below;
  const double width = area.bottom_right.x - area.top_left.x;
  double widest = 0.0;
  for (const auto& [value, text] : ticks_of(panel.x, {8, 8}))
    widest = std::max(widest, text_width(text, layout.font));
  const TickLimits limits{most_ticks(width, widest + 1.6 * layout.font),
                          most_ticks(width, widest + 0.6 * layout.font)};
  for (const auto& [value, text] : ticks_of(panel.x, limits)) {
    const double x = area.at(value, area.y.low).x;
    if (panel.x.named_ticks.empty())
      drawing.marks.push_back(Polyline{{{x, area.top_left.y}, {x, bottom}}, theme::kGrid, theme::kGridWidth});
    drawing.marks.push_back(
        Polyline{{{x, bottom}, {x, bottom + theme::kTickLength}}, theme::kFrame, theme::kFrameWidth});
    if (!has_texts) continue;
    drawing.marks.push_back(Label{{x, bottom + layout.tick_gap() + 0.75 * layout.font},
                                  text,
                                  layout.font,
                                  Anchor::kMiddle,
                                  theme::kBlack});
  }
  if (!has_texts || panel.x.title.empty()) return;
  drawing.marks.push_back(
      Label{{0.5 * (area.top_left.x + area.bottom_right.x), bottom + layout.tick_gap() + 2.05 * layout.font},
            panel.x.title,
            layout.font,
            Anchor::kMiddle,
            theme::kBlack});
}

void draw_y_axis(Drawing& drawing, const ChartPanel& panel, const PlotArea& area, const ChartLayout& layout) {
  const double left = area.top_left.x;
  const double height = area.bottom_right.y - area.top_left.y;
  const double room =
      left - layout.tick_gap() - layout.margin() - (panel.y.title.empty() ? 0.0 : 1.25 * layout.font);
  for (const auto& [value, text] : ticks_of(panel.y, y_tick_limits(layout, height))) {
    const double y = area.at(area.x.low, value).y;
    if (panel.y.named_ticks.empty())
      drawing.marks.push_back(
          Polyline{{{left, y}, {area.bottom_right.x, y}}, theme::kGrid, theme::kGridWidth});
    drawing.marks.push_back(
        Polyline{{{left - theme::kTickLength, y}, {left, y}}, theme::kFrame, theme::kFrameWidth});
    drawing.marks.push_back(centered_label({left - layout.tick_gap(), y},
                                           shortened(text, layout.font, room + 0.5), layout.font,
                                           Anchor::kRight));
  }
  if (panel.y.title.empty()) return;
  drawing.marks.push_back(
      Label{{layout.margin() + 0.75 * layout.font, 0.5 * (area.top_left.y + area.bottom_right.y)},
            panel.y.title,
            layout.font,
            Anchor::kMiddle,
            theme::kBlack,
            true});
}

void draw_panel(Drawing& drawing, const ChartPanel& panel, const PlotArea& area, const ChartLayout& layout) {
  if (!panel.has_axes) return panel.draw(drawing, area);
  draw_x_axis(drawing, panel, area, layout);
  draw_y_axis(drawing, panel, area, layout);
  const auto& [left, top] = area.top_left;
  const auto& [right, bottom] = area.bottom_right;
  panel.draw(drawing, area);
  drawing.marks.push_back(Polyline{{{left, top}, {right, top}, {right, bottom}, {left, bottom}, {left, top}},
                                   theme::kFrame,
                                   theme::kFrameWidth});
}

/// The area of a panel; with the same scale on both axes, the shorter range is extended if the panel would be
/// very flat or higher than wide.
PlotArea area_of(const ChartPanel& panel, const Point2& top_left, double width) {
  PlotArea area{top_left, {top_left.x + width, top_left.y + panel.height}, panel.x.range, panel.y.range};
  if (panel.height > 0.0) return area;
  constexpr double kLeastHeight = 0.12;  // of the width
  constexpr double kMostHeight = 1.0;
  const double ratio = std::clamp(area.y.length() / area.x.length(), kLeastHeight, kMostHeight);
  const auto extended = [](const ValueRange& range, double length) {
    const double pad = std::max(0.0, 0.5 * (length - range.length()));
    return ValueRange{range.low - pad, range.high + pad};
  };
  area.x = extended(area.x, area.y.length() / ratio);
  area.y = extended(area.y, area.x.length() * ratio);
  area.bottom_right.y = top_left.y + ratio * width;
  return area;
}

constexpr double kSampleEm = 2.6;  // length of a line sample

/// Draws the legend with its top at `drawing.height`, which becomes its bottom.
void draw_legend(Drawing& drawing, const Chart& chart, const ChartLayout& layout) {
  const double font = layout.font;
  const std::size_t columns = chart.legend_heads.size();
  std::vector<double> widths(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    widths[c] = text_width(chart.legend_heads[c], font);
    for (const LegendRow& row : chart.legend) {
      if (c < row.numbers.size()) widths[c] = std::max(widths[c], text_width(row.numbers[c], font));
    }
    widths[c] += 0.9 * font;
  }
  double numbers_left = layout.width - layout.right_margin();
  for (const double width : widths) numbers_left -= width;
  double baseline = drawing.height + 0.95 * font;
  const auto write_row = [&](const std::vector<std::string>& cells) {
    double right = numbers_left;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      right += widths[c];
      drawing.marks.push_back(Label{{right, baseline}, cells[c], font, Anchor::kRight, theme::kBlack});
    }
    baseline += layout.line_height();
  };
  if (columns > 0 && !chart.legend.empty()) write_row(chart.legend_heads);
  const double left = layout.margin();
  const double name_left = left + (kSampleEm + 0.6) * font;
  for (const LegendRow& row : chart.legend) {
    const double y = baseline - 0.36 * font;
    const double right = left + kSampleEm * font;
    if (row.is_area) {
      const double half = 0.3 * font;
      drawing.marks.push_back(Polygon{
          {{left, y - half}, {right, y - half}, {right, y + half}, {left, y + half}}, row.style.color});
    } else {
      drawing.marks.push_back(styled_line({{left, y}, {right, y}}, row.style, row.width));
    }
    drawing.marks.push_back(Label{{name_left, baseline},
                                  shortened(row.name, font, numbers_left - name_left),
                                  font,
                                  Anchor::kLeft,
                                  theme::kBlack});
    write_row(row.numbers);
  }
  drawing.height = baseline - 0.95 * font + 0.35 * font;
}

/// "start" and "end" with their marks, in the row of the heads of the legend.
void draw_start_and_end(Drawing& drawing, const ChartLayout& layout) {
  const double font = layout.font;
  const double baseline = layout.margin() + 0.95 * font;
  const double y = baseline - 0.36 * font;
  double x = layout.margin() + 0.5 * font;
  add_marks(drawing, start_mark({x, y}, theme::kBlack));
  x += 0.6 * font;
  drawing.marks.push_back(Label{{x, baseline}, "start", font, Anchor::kLeft, theme::kBlack});
  x += text_width("start", font) + 1.2 * font;
  add_marks(drawing, end_mark({x, y}, theme::kBlack));
  drawing.marks.push_back(Label{{x + 0.6 * font, baseline}, "end", font, Anchor::kLeft, theme::kBlack});
}

/// Draws the color bar with its top at `drawing.height`, which becomes its bottom.
void draw_color_bar(Drawing& drawing, const ColorBar& bar, const PlotArea& above, const ChartLayout& layout) {
  constexpr int kSteps = 96;
  constexpr double kHeightEm = 0.7;
  const double top = drawing.height + 0.3 * layout.font;
  const double bottom = top + kHeightEm * layout.font;
  const ValueRange range{bar.least, bar.most};
  const PlotArea area{{above.top_left.x, top}, {above.bottom_right.x, bottom}, range, {0.0, 1.0}};
  for (int k = 0; k < kSteps; ++k) {
    const double from = range.low + range.length() * k / kSteps;
    // Steps overlap, since viewers show gaps between adjacent polygons.
    const double to = range.low + range.length() * std::min(k + 2, kSteps) / kSteps;
    drawing.marks.push_back(
        Polygon{{area.at(from, 0.0), area.at(to, 0.0), area.at(to, 1.0), area.at(from, 1.0)},
                error_color(k + 0.5, kSteps)});
  }
  ChartPanel axis{.x = {range, bar.title}, .y = {}};
  draw_x_axis(drawing, axis, area, layout);
  drawing.height = bottom + layout.x_axis_height(true);
}

/// Draws a text below `drawing.height`, broken between words at the width of the drawing.
void draw_note(Drawing& drawing, const std::string& note, const ChartLayout& layout) {
  const double font = 0.85 * layout.font;
  for (std::size_t begin = 0; begin < note.size();) {
    std::size_t end = std::string::npos;  // of the line
    for (std::size_t space = note.find(' ', begin);; space = note.find(' ', space + 1)) {
      const bool fits =
          text_width(note.substr(begin, space - begin), font) <= layout.width - 2.0 * layout.margin();
      if (end == std::string::npos || fits) end = std::min(space, note.size());
      if (!fits || space == std::string::npos) break;
    }
    drawing.height += 1.3 * font;
    drawing.marks.push_back(Label{{layout.margin(), drawing.height - 0.2 * layout.font},
                                  note.substr(begin, end - begin),
                                  font,
                                  Anchor::kLeft,
                                  theme::kFrame});
    begin = end + 1;
  }
}

}  // namespace

Drawing draw_chart(const Chart& chart, const FigureSize& size) {
  constexpr double kPointsPerMm = 72.0 / 25.4;
  const ChartLayout layout{size.width_mm * kPointsPerMm, size.font_size_pt};
  Drawing drawing{.width = layout.width, .height = layout.margin(), .marks = {}};
  drawing.title = chart.title;
  drawing.unit_is_a_point = true;
  if (!chart.legend.empty()) draw_legend(drawing, chart, layout);
  if (chart.start_and_end) draw_start_and_end(drawing, layout);
  const double left = left_margin(chart, layout);
  PlotArea area;
  for (ChartPanel panel : chart.panels) {
    drawing.height += 0.5 * layout.font;
    if (panel.height > 0.0)
      panel.height = std::max(panel.height, text_width(panel.y.title, layout.font) + 0.5 * layout.font);
    area = area_of(panel, {left, drawing.height}, layout.width - left - layout.right_margin());
    panel.x.range = area.x;
    panel.y.range = area.y;
    draw_panel(drawing, panel, area, layout);
    drawing.height =
        area.bottom_right.y +
        (panel.shares_x_below ? theme::kTickLength : layout.x_axis_height(!panel.x.title.empty()));
  }
  if (chart.color_bar) draw_color_bar(drawing, *chart.color_bar, area, layout);
  draw_note(drawing, chart.note, layout);
  drawing.height += layout.margin() + 0.3 * layout.font;
  return drawing;
}

}  // namespace stillpoint::report
