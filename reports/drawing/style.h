// SPDX-License-Identifier: BSD-3-Clause
/// Size and colors that plots have in common.
#pragma once

#include <array>

#include "reports/drawing/drawing.h"

namespace stillpoint::report {

inline constexpr double kPlotWidth = 800.0;
inline constexpr double kPlotMargin = 60.0;
inline constexpr Color kBlack{20, 20, 20};
inline constexpr Color kGray{200, 200, 200};
inline constexpr Color kBlue{30, 90, 200};
inline constexpr Color kRed{190, 30, 40};
/// Of the lines of a plot, in their order.
inline constexpr std::array<Color, 6> kLineColors{
    {kBlue, {220, 110, 20}, {40, 150, 60}, {170, 50, 160}, kRed, {100, 100, 100}}};

}  // namespace stillpoint::report
