// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/drawing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"
#include "eval/io/base64.h"
#include "reports/drawing/drawing_module.h"
#include "reports/drawing/name_spans.h"
#include "reports/drawing/theme.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

std::string hex(const Color& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

std::string points_attribute(const std::vector<Point2>& points) {
  std::string text;
  for (const Point2& point : points) text += fmt::format("{:.2f},{:.2f} ", point.x, point.y);
  if (!text.empty()) text.pop_back();
  return "points=\"" + text + "\"";
}

double plain_text_width(const std::string& text, double size) {
  if (const DrawingModule* const module = drawing_module())
    return module->text_width(text, size, theme::kFonts);
  constexpr double kMeanWidth = 0.56;  // of a digit of Helvetica, per font size
  const auto begins_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  return kMeanWidth * size * static_cast<double>(std::ranges::count_if(text, begins_character));
}

/// The marks of a drawing, a label for each span of a name. Horizontal texts only: names are.
std::vector<Mark> marks_of_spans(const std::vector<Mark>& marks) {
  std::vector<Mark> expanded;
  expanded.reserve(marks.size());
  for (const Mark& mark : marks) {
    const Label* const label = std::get_if<Label>(&mark);
    const std::vector<NameSpan> spans =
        label == nullptr || label->upwards ? std::vector<NameSpan>{} : name_spans(label->text);
    if (spans.empty() || (spans.size() == 1 && spans[0].text == label->text)) {
      expanded.push_back(mark);
      continue;
    }
    const double width = text_width(label->text, label->size);
    Label part = *label;
    part.anchor = Anchor::kLeft;
    part.at.x -= label->anchor == Anchor::kLeft     ? 0.0
                 : label->anchor == Anchor::kMiddle ? 0.5 * width
                                                    : width;
    for (const NameSpan& span : spans) {
      part.text = span.text;
      part.size = span.scale * label->size;
      part.at.y = label->at.y - span.rise * label->size;
      expanded.push_back(part);
      part.at.x += plain_text_width(part.text, part.size);
    }
  }
  return expanded;
}

/// As it is written to a file.
Drawing with_spans(Drawing drawing) {
  drawing.marks = marks_of_spans(drawing.marks);
  return drawing;
}

struct SvgWriter {
  std::string& out;

  void operator()(const Polyline& line) const {
    out += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2f}\" ", hex(line.color),
                       line.width);
    if (!line.dashes.empty())
      out += fmt::format("stroke-linecap=\"butt\" stroke-dasharray=\"{:g}\" ", fmt::join(line.dashes, " "));
    out += points_attribute(line.points) + "/>\n";
  }
  void operator()(const Polygon& polygon) const {
    out += fmt::format("<polygon fill=\"{}\" {}/>\n", hex(polygon.color), points_attribute(polygon.points));
  }
  void operator()(const Disc& disc) const {
    out += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\"/>\n", disc.center.x,
                       disc.center.y, disc.radius, hex(disc.color));
  }
  void operator()(const Label& label) const {
    constexpr const char* kAnchors[] = {"start", "middle", "end"};
    out += fmt::format(
        "<text x=\"{0:.2f}\" y=\"{1:.2f}\" font-size=\"{2:.2f}\" text-anchor=\"{3}\" fill=\"{4}\"",
        label.at.x, label.at.y, label.size, kAnchors[static_cast<int>(label.anchor)], hex(label.color));
    if (label.upwards) out += fmt::format(" transform=\"rotate(-90 {:.2f} {:.2f})\"", label.at.x, label.at.y);
    out += fmt::format(">{}</text>\n", escape_html(label.text));
  }
  void operator()(const Raster& raster) const {
    Raster alone = raster;
    alone.top_left = {0.0, 0.0};
    alone.bottom_right = {static_cast<double>(raster.columns), static_cast<double>(raster.rows())};
    const std::string png =
        png_bytes({.width = alone.bottom_right.x, .height = alone.bottom_right.y, .marks = {alone}}, 1.0);
    out += fmt::format(
        "<image x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" preserveAspectRatio=\"none\" "
        "style=\"image-rendering:pixelated\" xlink:href=\"data:image/png;base64,{}\"/>\n",
        raster.top_left.x, raster.top_left.y, raster.bottom_right.x - raster.top_left.x,
        raster.bottom_right.y - raster.top_left.y, eval::base64(png));
  }
};

}  // namespace

std::string svg_text(const Drawing& drawing) {
  const char* const unit = drawing.unit_is_a_point ? "pt" : "";
  const bool has_raster = std::ranges::any_of(
      drawing.marks, [](const Mark& mark) { return std::holds_alternative<Raster>(mark); });
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\"{4} viewBox=\"0 0 {0:.2f} {1:.2f}\" width=\"{0:.2f}{2}\" "
      "height=\"{1:.2f}{2}\" font-family=\"{3}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n",
      drawing.width, drawing.height, unit, theme::kFonts,
      has_raster ? " xmlns:xlink=\"http://www.w3.org/1999/xlink\"" : "");
  if (!drawing.title.empty()) out += fmt::format("<title>{}</title>\n", escape_html(drawing.title));
  out += "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const Mark& mark : marks_of_spans(drawing.marks)) std::visit(SvgWriter{out}, mark);
  return out + "</svg>\n";
}

std::string html_text(std::span<const Drawing> drawings) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";
  out += escape_html(drawings.front().title);
  out +=
      "</title>\n<style>body { margin: 1rem; background: #fff } "
      "svg { display: block; width: 48rem; max-width: 100%; height: auto; margin: 0 auto 2rem "
      "}</style></head>\n"
      "<body>\n";
  for (const Drawing& drawing : drawings) out += svg_text(drawing);
  return out + "</body></html>\n";
}

namespace {

const DrawingModule& require_drawing_module(const char* format) {
  const DrawingModule* const module = drawing_module();
  if (module != nullptr) return *module;
  throw InputError(format,
                   "this build writes none (STILLPOINT_MINIMAL); write .svg or .html, or use a full build");
}

}  // namespace

std::string pdf_text(std::span<const Drawing> drawings) {
  std::vector<Drawing> pages;
  for (const Drawing& drawing : drawings) pages.push_back(with_spans(drawing));
  return require_drawing_module("PDF").pdf(pages, theme::kFonts);
}

std::string png_bytes(const Drawing& drawing, double scale) {
  std::string bytes = require_drawing_module("PNG").png(with_spans(drawing), scale, theme::kFonts);
  if (bytes.empty()) {
    throw InputError(
        "PNG", fmt::format("{:.0f} x {:.0f} pixels are too many; draw fewer figures, or write .pdf or .svg",
                           drawing.width * scale, drawing.height * scale));
  }
  return bytes;
}

double text_width(const std::string& text, double size) {
  double width = 0.0;
  for (const NameSpan& span : name_spans(text)) width += plain_text_width(span.text, span.scale * size);
  return width;
}

namespace {

/// Moves a mark down.
struct MoveDown {
  double by = 0.0;

  void operator()(Polyline& line) const { move(line.points); }
  void operator()(Polygon& polygon) const { move(polygon.points); }
  void operator()(Disc& disc) const { disc.center.y += by; }
  void operator()(Label& label) const { label.at.y += by; }
  void operator()(Raster& raster) const {
    raster.top_left.y += by;
    raster.bottom_right.y += by;
  }

 private:
  void move(std::vector<Point2>& points) const {
    for (Point2& point : points) point.y += by;
  }
};

}  // namespace

Drawing stacked(std::span<const Drawing> drawings) {
  Drawing all{.width = 0.0, .height = 0.0, .marks = {}};
  for (const Drawing& drawing : drawings) {
    for (Mark mark : drawing.marks) {
      std::visit(MoveDown{all.height}, mark);
      all.marks.push_back(std::move(mark));
    }
    all.width = std::max(all.width, drawing.width);
    all.height += drawing.height;
  }
  all.title = drawings.front().title;
  all.unit_is_a_point = drawings.front().unit_is_a_point;
  return all;
}

namespace {

/// A file format of drawings.
struct DrawingFormat {
  const char* extension;
  const char* beginning;  ///< of its files
  const char* name;       ///< of formats that the module writes, else null
  std::string (*text)(std::span<const Drawing>, double scale);
};
constexpr DrawingFormat kFormats[] = {
    {".svg", "<svg", nullptr,
     [](std::span<const Drawing> drawings, double) { return svg_text(stacked(drawings)); }},
    {".pdf", "%PDF", "PDF", [](std::span<const Drawing> drawings, double) { return pdf_text(drawings); }},
    {".png", "\x89PNG", "PNG",
     [](std::span<const Drawing> drawings, double scale) { return png_bytes(stacked(drawings), scale); }},
    {".html", "<!doctype html>", nullptr,
     [](std::span<const Drawing> drawings, double) { return html_text(drawings); }}};

const DrawingFormat& format_of(const std::filesystem::path& file) {
  for (const DrawingFormat& format : kFormats) {
    if (file.extension() == format.extension) return format;
  }
  throw InputError(file.string(), "has no extension of a drawing; use one of: .svg, .pdf, .png, .html");
}

}  // namespace

void require_drawing_file(const std::filesystem::path& file, bench::OutputRules rules) {
  const DrawingFormat& format = format_of(file);
  if (format.name != nullptr) static_cast<void>(require_drawing_module(format.name));
  rules.beginning = format.beginning;
  bench::require_safe_output(file, rules);
}

void write_drawings(const std::filesystem::path& file, std::span<const Drawing> drawings, double scale,
                    bench::OutputRules rules) {
  require_drawing_file(file, rules);
  const DrawingFormat& format = format_of(file);
  rules.beginning = format.beginning;
  bench::write_output(file, format.text(drawings, scale), rules);
}

}  // namespace stillpoint::report
