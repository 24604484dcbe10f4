// SPDX-License-Identifier: BSD-3-Clause
/// Vector drawing as a list of marks, written as SVG, PDF or PNG.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

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

}  // namespace stillpoint::report
