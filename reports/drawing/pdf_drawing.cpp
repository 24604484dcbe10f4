// SPDX-License-Identifier: BSD-3-Clause
#include <cairo-pdf.h>
#include <cairo.h>

#include <memory>
#include <numbers>

#include "reports/drawing/drawing.h"

namespace stillpoint::report {
namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

/// Appends to the std::string at `text`.
cairo_status_t append(void* text, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

class PdfPage {
 public:
  explicit PdfPage(cairo_t* context) : context_(context) {}

  void operator()(const Polyline& line) const {
    set_color(line.color);
    cairo_set_line_width(context_, line.width);
    cairo_new_path(context_);
    for (const Point2& point : line.points) cairo_line_to(context_, point.x, point.y);
    cairo_stroke(context_);
  }
  void operator()(const Disc& disc) const {
    set_color(disc.color);
    cairo_new_path(context_);
    cairo_arc(context_, disc.center.x, disc.center.y, disc.radius, 0.0, 2.0 * std::numbers::pi);
    cairo_fill(context_);
  }
  void operator()(const Label& label) const {
    set_color(label.color);
    cairo_set_font_size(context_, label.size);
    cairo_text_extents_t extents;
    cairo_text_extents(context_, label.text.c_str(), &extents);
    const double shift = label.anchor == Anchor::kLeft     ? 0.0
                         : label.anchor == Anchor::kMiddle ? 0.5 * extents.x_advance
                                                           : extents.x_advance;
    cairo_move_to(context_, label.at.x - shift, label.at.y);
    cairo_show_text(context_, label.text.c_str());
  }

 private:
  void set_color(const Color& color) const {
    cairo_set_source_rgb(context_, color.red / 255.0, color.green / 255.0, color.blue / 255.0);
  }

  cairo_t* context_;
};

}  // namespace

std::string pdf_text(const Drawing& drawing) {
  std::string text;
  {
    const Surface surface(cairo_pdf_surface_create_for_stream(append, &text, drawing.width, drawing.height),
                          &cairo_surface_destroy);
    cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);  // every LaTeX includes it
    // Without a date equal drawings give equal bytes.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
    const Context context(cairo_create(surface.get()), &cairo_destroy);
    cairo_select_font_face(context.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
    for (const Mark& mark : drawing.marks) std::visit(PdfPage(context.get()), mark);
  }  // the end of the surface writes the end of the document
  return text;
}

}  // namespace stillpoint::report
