// SPDX-License-Identifier: BSD-3-Clause
/// Box plot of module times: quartiles, 5th and 95th percentile, and maximum.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stillpoint::report {

struct PlotBox {
  std::string group;  ///< heading of consecutive boxes, e.g. the module
  std::string label;
  double p5 = 0.0;
  double q1 = 0.0;
  double median = 0.0;
  double q3 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
  std::size_t count = 0;
};

/// @return nullopt without values
[[nodiscard]] std::optional<PlotBox> box_of(std::string group, std::string label,
                                            std::span<const double> values);

/// An SVG on a logarithmic axis, colored by the page's style sheet; empty without boxes.
[[nodiscard]] std::string box_plot_svg(std::span<const PlotBox> boxes, const std::string& title,
                                       const std::string& unit);

}  // namespace stillpoint::report
