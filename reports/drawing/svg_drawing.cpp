// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/drawing.h"

#include <fmt/format.h>

#include "reports/tables/escaping.h"

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

}  // namespace stillpoint::report
