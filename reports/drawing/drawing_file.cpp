// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/drawing_file.h"

#include "core/base/error.h"

namespace stillpoint::report {
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
