// SPDX-License-Identifier: BSD-3-Clause
/// How long modules take, as boxes: quartiles, 5 and 95 %, and the longest.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stillpoint {

struct PlotBox {
  std::string group;  ///< heading of neighbouring boxes, e.g. the module
  std::string label;
  double p5 = 0.0;
  double q1 = 0.0;
  double median = 0.0;
  double q3 = 0.0;
  double p95 = 0.0;
  double largest = 0.0;
  std::size_t count = 0;
};

/// @return nothing without values
[[nodiscard]] std::optional<PlotBox> box_of(std::string group, std::string label,
                                            std::span<const double> values);

/// An SVG on a logarithmic axis, coloured by the page's style sheet; empty without boxes.
[[nodiscard]] std::string box_plot_svg(std::span<const PlotBox> boxes, const std::string& title,
                                       const std::string& unit);

}  // namespace stillpoint
