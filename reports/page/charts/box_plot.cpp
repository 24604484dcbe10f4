// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/box_plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "eval/metrics/statistics.h"
#include "reports/tables/escaping.h"

namespace stillpoint::report {
namespace {

constexpr double kWidth = 900.0;
constexpr double kLabelWidth = 330.0;
constexpr double kRightMargin = 40.0;  // half of the last tick label
constexpr double kRowHeight = 20.0;
constexpr double kAxisHeight = 30.0;
constexpr double kMinAxisValue = 1e-3;  // 1 us on an axis in ms

/// Logarithmic axis over whole decades.
struct LogAxis {
  double low = 0.0;  ///< exponents of ten
  double high = 1.0;

  [[nodiscard]] double operator()(double value) const {
    const double fraction = (std::log10(std::max(value, std::pow(10.0, low))) - low) / (high - low);
    return kLabelWidth + fraction * (kWidth - kLabelWidth - kRightMargin);
  }
};

LogAxis axis_of(std::span<const PlotBox> boxes) {
  double low = boxes.front().p5;
  double high = boxes.front().max;
  for (const PlotBox& box : boxes) {
    low = std::min(low, box.p5);
    high = std::max(high, box.max);
  }
  LogAxis axis{std::floor(std::log10(std::max(low, kMinAxisValue))),
               std::ceil(std::log10(std::max(high, kMinAxisValue)))};
  if (axis.high <= axis.low) axis.high = axis.low + 1.0;
  return axis;
}

std::string ticks_svg(const LogAxis& axis, double height, const std::string& unit) {
  std::string text;
  for (double exponent = axis.low; exponent <= axis.high; exponent += 1.0) {
    const double value = std::pow(10.0, exponent);
    const double x = axis(value);
    text += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.1f}\"/>"
        "<text class=\"tick\" x=\"{0:.1f}\" y=\"{2:.1f}\">{3:g} {4}</text>",
        x, height, height + 18.0, value, escape_html(unit));
  }
  return text;
}

std::string box_svg(const PlotBox& box, const LogAxis& axis, double y) {
  const double middle = y + kRowHeight / 2.0;
  std::string text = fmt::format(
      "<g><title>{} {}: median {:.3g}, quartiles {:.3g} to {:.3g}, 95th percentile {:.3g}, max "
      "{:.3g}, {} frames</title>",
      escape_html(box.group), escape_html(box.label), box.median, box.q1, box.q3, box.p95, box.max,
      box.count);
  text += fmt::format("<text class=\"name\" x=\"{}\" y=\"{:.1f}\">{} (n = {})</text>", kLabelWidth - 8.0,
                      middle + 4.0, escape_html(box.label), box.count);
  text += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", axis(box.p5),
                      axis(box.p95), middle, middle);
  text += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", axis(box.q1),
                      y + 4.0, std::max(axis(box.q3) - axis(box.q1), 1.0), kRowHeight - 8.0);
  text += fmt::format("<line class=\"median\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                      axis(box.median), y + 3.0, y + kRowHeight - 3.0);
  return text + fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\"/></g>\n", axis(box.max), middle);
}

}  // namespace

std::optional<PlotBox> box_of(std::string group, std::string label, std::span<const double> values) {
  if (values.empty()) return std::nullopt;
  const auto at = [&](double fraction) { return eval::percentile(values, fraction).value(); };
  return PlotBox{.group = std::move(group),
                 .label = std::move(label),
                 .p5 = at(0.05),
                 .q1 = at(0.25),
                 .median = at(0.5),
                 .q3 = at(0.75),
                 .p95 = at(0.95),
                 .max = at(1.0),
                 .count = values.size()};
}

std::string box_plot_svg(std::span<const PlotBox> boxes, const std::string& title, const std::string& unit) {
  if (boxes.empty()) return "";
  const LogAxis axis = axis_of(boxes);
  std::string marks;
  std::string group;
  double y = 0.0;
  for (const PlotBox& box : boxes) {
    if (box.group != group) {
      marks += fmt::format("<text class=\"group\" x=\"4\" y=\"{:.1f}\">{}</text>\n", y + kRowHeight - 6.0,
                           escape_html(box.group));
      group = box.group;
      y += kRowHeight;
    }
    marks += box_svg(box, axis, y);
    y += kRowHeight;
  }
  return fmt::format("<svg class=\"boxes\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {:.1f}\">\n",
                     escape_html(title), kWidth, y + kAxisHeight) +
         ticks_svg(axis, y, unit) + marks + "</svg>\n";
}

}  // namespace stillpoint::report
