// SPDX-License-Identifier: BSD-3-Clause
/// Source of libstillpoint_drawing.so. It is linked with no other source of the project.
#include "reports/drawing/drawing_module.h"

#include <cairo-pdf.h>
#include <cairo.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace stillpoint::report {
namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;
using FontOptions = std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)>;
using FontDescription = std::unique_ptr<PangoFontDescription, decltype(&pango_font_description_free)>;

struct Unreference {
  void operator()(void* object) const { g_object_unref(object); }
};
using Layout = std::unique_ptr<PangoLayout, Unreference>;

/// Appends to the std::string at `text`.
cairo_status_t append(void* text, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

/// One line of text, not fitted to pixels: it has the same widths in every format.
Layout layout_of(cairo_t* context, const std::string& text, double size, const char* fonts) {
  Layout layout(pango_cairo_create_layout(context));
  PangoContext* const settings = pango_layout_get_context(layout.get());
  const FontOptions options(cairo_font_options_create(), &cairo_font_options_destroy);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  pango_cairo_context_set_font_options(settings, options.get());
  pango_context_set_round_glyph_positions(settings, FALSE);
  const FontDescription font(pango_font_description_from_string(fonts), &pango_font_description_free);
  pango_font_description_set_absolute_size(font.get(), size * PANGO_SCALE);
  pango_layout_set_font_description(layout.get(), font.get());
  pango_layout_set_text(layout.get(), text.data(), static_cast<int>(text.size()));
  return layout;
}

double width_of(PangoLayout* layout) {
  PangoRectangle extents;
  pango_layout_get_extents(layout, nullptr, &extents);
  return static_cast<double>(extents.width) / PANGO_SCALE;
}

/// Draws marks.
class Painter {
 public:
  Painter(cairo_t* context, const char* fonts) : context_(context), fonts_(fonts) {}

  void operator()(const Polyline& line) const {
    set_color(line.color);
    cairo_set_line_width(context_, line.width);
    cairo_set_line_cap(context_, line.dashes.empty() ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_set_dash(context_, line.dashes.data(), static_cast<int>(line.dashes.size()), 0.0);
    trace(line.points);
    cairo_stroke(context_);
  }
  void operator()(const Polygon& polygon) const {
    set_color(polygon.color);
    trace(polygon.points);
    cairo_fill(context_);
  }
  void operator()(const Disc& disc) const {
    set_color(disc.color);
    cairo_new_path(context_);
    cairo_arc(context_, disc.center.x, disc.center.y, disc.radius, 0.0, 2.0 * std::numbers::pi);
    cairo_fill(context_);
  }
  void operator()(const Label& label) const {
    set_color(label.color);
    const Layout layout = layout_of(context_, label.text, label.size, fonts_);
    const double width = width_of(layout.get());
    const double shift = label.anchor == Anchor::kLeft     ? 0.0
                         : label.anchor == Anchor::kMiddle ? 0.5 * width
                                                           : width;
    cairo_save(context_);
    cairo_translate(context_, label.at.x, label.at.y);
    if (label.upwards) cairo_rotate(context_, -0.5 * std::numbers::pi);
    cairo_move_to(context_, -shift,
                  -static_cast<double>(pango_layout_get_baseline(layout.get())) / PANGO_SCALE);
    pango_cairo_show_layout(context_, layout.get());
    cairo_restore(context_);
  }
  void operator()(const Raster& raster) const {
    const int columns = static_cast<int>(raster.columns);
    const int rows = static_cast<int>(raster.rows());
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, columns, rows),
                          &cairo_surface_destroy);
    unsigned char* const data = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    for (int row = 0; row < rows; ++row) {
      const unsigned char* const from = &raster.pixels[static_cast<std::size_t>(row) * raster.columns * 3];
      for (int column = 0; column < columns; ++column)  // blue, green, red and an unused byte
        std::reverse_copy(from + 3 * column, from + 3 * column + 3, data + row * stride + 4 * column);
    }
    cairo_surface_mark_dirty(surface.get());
    cairo_save(context_);
    cairo_translate(context_, raster.top_left.x, raster.top_left.y);
    cairo_scale(context_, (raster.bottom_right.x - raster.top_left.x) / columns,
                (raster.bottom_right.y - raster.top_left.y) / rows);
    cairo_set_source_surface(context_, surface.get(), 0.0, 0.0);
    cairo_pattern_set_filter(cairo_get_source(context_), CAIRO_FILTER_NEAREST);
    cairo_rectangle(context_, 0.0, 0.0, columns, rows);
    cairo_fill(context_);
    cairo_restore(context_);
  }

 private:
  void set_color(const Color& color) const {
    cairo_set_source_rgb(context_, color.red / 255.0, color.green / 255.0, color.blue / 255.0);
  }
  void trace(const std::vector<Point2>& points) const {
    cairo_new_path(context_);
    for (const Point2& point : points) cairo_line_to(context_, point.x, point.y);
  }

  cairo_t* context_;
  const char* fonts_;
};

void paint(cairo_t* context, const Drawing& drawing, const char* fonts) {
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  for (const Mark& mark : drawing.marks) std::visit(Painter(context, fonts), mark);
}

std::string pdf(std::span<const Drawing> pages, const char* fonts) {
  std::string text;
  {
    const Surface surface(cairo_pdf_surface_create_for_stream(append, &text, pages[0].width, pages[0].height),
                          &cairo_surface_destroy);
    cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);  // every LaTeX includes it
    // Without a date equal drawings give equal bytes.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
    if (!pages[0].title.empty())
      cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, pages[0].title.c_str());
    const Context context(cairo_create(surface.get()), &cairo_destroy);
    for (const Drawing& page : pages) {
      cairo_pdf_surface_set_size(surface.get(), page.width, page.height);
      paint(context.get(), page, fonts);
      cairo_show_page(context.get());
    }
  }  // the end of the surface writes the end of the document
  return text;
}

std::string png(const Drawing& drawing, double scale, const char* fonts) {
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(drawing.width * scale)),
                                 static_cast<int>(std::ceil(drawing.height * scale))),
      &cairo_surface_destroy);
  const Context context(cairo_create(surface.get()), &cairo_destroy);
  cairo_set_source_rgb(context.get(), 1.0, 1.0, 1.0);
  cairo_paint(context.get());
  cairo_scale(context.get(), scale, scale);
  paint(context.get(), drawing, fonts);
  cairo_surface_flush(surface.get());
  std::string bytes;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  return status == CAIRO_STATUS_SUCCESS ? bytes : "";
}

double text_width(const std::string& text, double size, const char* fonts) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1), &cairo_surface_destroy);
  const Context context(cairo_create(surface.get()), &cairo_destroy);
  return width_of(layout_of(context.get(), text, size, fonts).get());
}

}  // namespace

extern "C" const DrawingModule stillpoint_drawing_module;
const DrawingModule stillpoint_drawing_module = {.pdf = pdf, .png = png, .text_width = text_width};

}  // namespace stillpoint::report
