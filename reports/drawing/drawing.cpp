// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/drawing.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

std::string hex(const Color& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

struct Writer {
  std::string& out;

  void operator()(const Polyline& line) const {
    out += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2f}\" points=\"",
                       hex(line.color), line.width);
    for (const Point2& point : line.points) out += fmt::format("{:.2f},{:.2f} ", point.x, point.y);
    out.back() = '"';
    out += "/>\n";
  }
  void operator()(const Disc& disc) const {
    out += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\"/>\n", disc.center.x,
                       disc.center.y, disc.radius, hex(disc.color));
  }
  void operator()(const Label& label) const {
    constexpr const char* kAnchors[] = {"start", "middle", "end"};
    out += fmt::format(
        "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.2f}\" text-anchor=\"{}\" fill=\"{}\">{}</text>\n",
        label.at.x, label.at.y, label.size, kAnchors[static_cast<int>(label.anchor)], hex(label.color),
        escape_html(label.text));
  }
};

}  // namespace

std::string svg_text(const Drawing& drawing) {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.2f} {1:.2f}\" width=\"{0:.2f}\" "
      "height=\"{1:.2f}\" font-family=\"Helvetica, Arial, sans-serif\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      drawing.width, drawing.height);
  for (const Mark& mark : drawing.marks) std::visit(Writer{out}, mark);
  return out + "</svg>\n";
}

namespace {

/// A file format of drawings.
struct DrawingFormat {
  const char* extension;
  const char* beginning;                ///< of its files
  std::string (*text)(const Drawing&);  ///< null: an image, see write_drawing_png
};
constexpr DrawingFormat kFormats[] = {
    {".svg", "<svg", svg_text}, {".pdf", "%PDF", pdf_text}, {".png", "\x89PNG", nullptr}};

const DrawingFormat& format_of(const std::filesystem::path& file) {
  for (const DrawingFormat& format : kFormats) {
    if (file.extension() == format.extension) return format;
  }
  throw InputError(file.string(), "has no extension of a drawing; use one of: .svg, .pdf, .png");
}

}  // namespace

void require_drawing_file(const std::filesystem::path& file, bench::OutputRules rules) {
  rules.beginning = format_of(file).beginning;
  bench::require_safe_output(file, rules);
}

void write_drawing(const std::filesystem::path& file, const Drawing& drawing, double scale,
                   bench::OutputRules rules) {
  require_drawing_file(file, rules);
  const DrawingFormat& format = format_of(file);
  if (format.text == nullptr) return write_drawing_png(file, drawing, scale);
  rules.beginning = format.beginning;
  bench::write_output(file, format.text(drawing), rules);
}

}  // namespace stillpoint::report
