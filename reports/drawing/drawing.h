// SPDX-License-Identifier: BSD-3-Clause
/// Vector drawing as a list of marks, written as SVG, PDF or PNG, also to a file whose extension selects the
/// format.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "bench/record/output_folder.h"

namespace stillpoint::report {

/// RGB, each 0 .. 255.
struct Color {
  int red = 0;
  int green = 0;
  int blue = 0;
};

/// In units of the drawing: x to the right, y down.
struct Point2 {
  double x = 0.0;
  double y = 0.0;
};

struct Polyline {
  std::vector<Point2> points;
  Color color;
  double width = 1.0;
};

struct Disc {
  Point2 center;
  double radius = 1.0;
  Color color;
};

enum class Anchor { kLeft, kMiddle, kRight };

/// One line of text; `at` is on its baseline.
struct Label {
  Point2 at;
  std::string text;    ///< ASCII
  double size = 10.0;  ///< height of the font
  Anchor anchor = Anchor::kLeft;
  Color color;
};

using Mark = std::variant<Polyline, Disc, Label>;

/// White background; later marks are drawn over earlier ones.
struct Drawing {
  double width = 100.0;
  double height = 100.0;
  std::vector<Mark> marks;
};

/// A self-contained SVG 1.1 document. Coordinates have 2 decimals, so that equal drawings give equal bytes.
[[nodiscard]] std::string svg_text(const Drawing& drawing);

/// A PDF document of one page; one unit of the drawing is 1/72 inch. Equal drawings give equal bytes.
[[nodiscard]] std::string pdf_text(const Drawing& drawing);

/// Writes a PNG of `scale` pixels per unit of the drawing, antialiased.
/// @throws InputError if the file cannot be written
void write_drawing_png(const std::filesystem::path& file, const Drawing& drawing, double scale);

// Size and colors that plots have in common.
inline constexpr double kPlotWidth = 800.0;
inline constexpr double kPlotMargin = 60.0;
inline constexpr Color kBlack{20, 20, 20};
inline constexpr Color kGray{200, 200, 200};
inline constexpr Color kBlue{30, 90, 200};
inline constexpr Color kRed{190, 30, 40};
/// Of the lines of a plot, in their order.
inline constexpr std::array<Color, 6> kLineColors{
    {kBlue, {220, 110, 20}, {40, 150, 60}, {170, 50, 160}, kRed, {100, 100, 100}}};

/// Checks a file name before the work begins: its extension, and what it would replace.
/// @param rules without `beginning`, which the format determines
/// @throws InputError if the extension is not .svg, .pdf or .png, or as bench::require_safe_output
void require_drawing_file(const std::filesystem::path& file, bench::OutputRules rules);

/// Checks as `require_drawing_file`, and writes an SVG or PDF, or a PNG of `scale` pixels per unit of the
/// drawing.
/// @throws InputError in addition if the file cannot be written
void write_drawing(const std::filesystem::path& file, const Drawing& drawing, double scale,
                   bench::OutputRules rules);

}  // namespace stillpoint::report
