// SPDX-License-Identifier: BSD-3-Clause
/// The look of all drawings: fonts, colors, line styles and sizes.
///
/// The colors of estimates have a contrast of at least 3 to white paper, six different lightnesses for gray
/// printing, and pairwise distances of at least 30 in CIELAB for normal vision, protanopia, deuteranopia and
/// tritanopia (Machado et al., IEEE TVCG 2009); `figure_theme_test` computes this.
#pragma once

#include <array>

#include "reports/drawing/drawing.h"

namespace stillpoint::report::theme {

/// In the order of preference; all but the last have the widths of Helvetica.
inline constexpr const char* kFonts = "Liberation Sans, Arial, Helvetica, sans-serif";
inline constexpr double kFontSizePt = 8.0;      ///< default of figures
inline constexpr double kColumnWidthMm = 85.0;  ///< of a page with two columns
inline constexpr double kPageWidthMm = 180.0;
inline constexpr double kPixelsPerInch = 300.0;  ///< of figures as PNG

inline constexpr Color kBlack{20, 20, 20};
inline constexpr Color kWhite{255, 255, 255};
inline constexpr Color kFrame{90, 90, 90};
inline constexpr Color kGrid{228, 228, 228};

// Widths [1/72 inch].
inline constexpr double kFrameWidth = 0.5;
inline constexpr double kGridWidth = 0.35;
inline constexpr double kTruthWidth = 0.8;
inline constexpr double kEstimateWidth = 0.9;
inline constexpr double kColoredWidth = 2.4;  ///< of a path colored by its error
inline constexpr double kTickLength = 2.5;
inline constexpr double kMarkRadius = 2.2;

/// Color, and lengths of dashes and spaces in turn; 0 ends the list, which is empty for a solid line.
struct LineStyle {
  Color color;
  std::array<double, 4> dashes{};
};
inline constexpr LineStyle kTruth{kBlack, {3.5, 2.0}};
inline constexpr std::array<LineStyle, 6> kEstimates{{{{83, 133, 180}, {}},
                                                      {{192, 1, 19}, {7.0, 1.2}},
                                                      {{39, 41, 125}, {5.0, 1.2, 1.2, 1.2}},
                                                      {{222, 116, 117}, {1.4, 1.0}},
                                                      {{147, 67, 233}, {9.0, 1.2, 3.0, 1.2}},
                                                      {{113, 53, 79}, {2.8, 1.0}}}};

/// Of estimate `i`: beyond the number of colors, a color has the dashes of another one, so that 36 differ.
constexpr LineStyle style_of_estimate(std::size_t i) {
  constexpr std::size_t kCount = kEstimates.size();
  return {kEstimates[i % kCount].color, kEstimates[(i + i / kCount) % kCount].dashes};
}

/// x, y and z of a pose, as usual in robotics.
inline constexpr std::array<Color, 3> kPoseAxes{{{200, 30, 30}, {30, 140, 50}, {40, 80, 210}}};

/// From no error to the largest: viridis without its lightest quarter, dark for large errors.
inline constexpr std::array<Color, 7> kErrorColors{{{94, 201, 98},
                                                    {40, 174, 128},
                                                    {33, 145, 140},
                                                    {44, 114, 142},
                                                    {59, 82, 139},
                                                    {71, 45, 123},
                                                    {68, 1, 84}}};

/// Of the errors of a single estimate.
inline constexpr LineStyle kMean = kEstimates[1];
inline constexpr LineStyle kMedian = kEstimates[2];

// Drawings for the screen, in units of a pixel.
inline constexpr double kPlotWidth = 800.0;
inline constexpr double kPlotMargin = 60.0;
inline constexpr Color kGray{200, 200, 200};
inline constexpr Color kBlue{30, 90, 200};
inline constexpr Color kRed{190, 30, 40};

}  // namespace stillpoint::report::theme
