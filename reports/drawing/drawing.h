// SPDX-License-Identifier: BSD-3-Clause
/// Vector drawing as a list of marks, written as SVG, HTML, PDF or PNG to a file whose extension selects the
/// format.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
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
  std::vector<double> dashes = {};  ///< lengths of dashes and spaces in turn; empty: solid
};

/// A filled polygon.
struct Polygon {
  std::vector<Point2> points;
  Color color;
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
  std::string text;    ///< UTF-8; horizontal ones with the notation of name_spans.h
  double size = 10.0;  ///< height of the font
  Anchor anchor = Anchor::kLeft;
  Color color;
  bool upwards = false;  ///< from bottom to top
};

/// An image, drawn without interpolation.
struct Raster {
  Point2 top_left;
  Point2 bottom_right;
  std::size_t columns = 0;
  /// Red, green and blue of each pixel, row by row from the top; not empty.
  std::vector<unsigned char> pixels;

  [[nodiscard]] std::size_t rows() const { return pixels.size() / (3 * columns); }
};

using Mark = std::variant<Polyline, Polygon, Disc, Label, Raster>;

/// White background; later marks are drawn over earlier ones.
struct Drawing {
  double width = 100.0;
  double height = 100.0;
  std::vector<Mark> marks;
  std::string title = {};        ///< empty: none
  bool unit_is_a_point = false;  ///< in SVG one unit is 1/72 inch, as in PDF; else a pixel
};

/// A self-contained SVG 1.1 document, texts as text, a `Raster` as PNG. Coordinates have 2 decimals, so that
/// equal drawings give equal bytes.
/// @throws InputError for a `Raster` as `png_bytes`
[[nodiscard]] std::string svg_text(const Drawing& drawing);

/// A self-contained page with one SVG element per drawing.
[[nodiscard]] std::string html_text(std::span<const Drawing> drawings);

/// A PDF document of one page per drawing with embedded fonts; one unit of the drawing is 1/72 inch. Equal
/// drawings give equal bytes.
/// @throws InputError if this build has no cairo
[[nodiscard]] std::string pdf_text(std::span<const Drawing> drawings);

/// The bytes of a PNG of `scale` pixels per unit of the drawing, antialiased.
/// @throws InputError if this build has no cairo, or for more than 32767 rows or columns
[[nodiscard]] std::string png_bytes(const Drawing& drawing, double scale);

/// Width of a text [units of the drawing]; an estimate in a build without pango.
[[nodiscard]] double text_width(const std::string& text, double size);

/// The drawings below each other.
[[nodiscard]] Drawing stacked(std::span<const Drawing> drawings);

/// Checks a file name before the work begins: its extension, and what it would replace.
/// @param rules without `beginning`, which the format determines
/// @throws InputError if the extension is not .svg, .pdf, .png or .html, or as bench::require_safe_output
void require_drawing_file(const std::filesystem::path& file, bench::OutputRules rules);

/// Checks as `require_drawing_file`, and writes a PDF with a page per drawing, a page of HTML, or an SVG or
/// PNG with the drawings below each other.
/// @param file path with the extension of its format
/// @param drawings at least one
/// @param scale pixels per unit, for PNG
/// @param rules as for `require_drawing_file`
/// @throws InputError in addition if the file cannot be written
void write_drawings(const std::filesystem::path& file, std::span<const Drawing> drawings, double scale,
                    bench::OutputRules rules);

}  // namespace stillpoint::report
