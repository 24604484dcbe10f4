// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/drawing_file.h"

#include "core/base/error.h"

namespace stillpoint::report {
namespace {

constexpr const char* kPngBeginning = "\x89PNG";

bool is_png(const std::filesystem::path& file) { return file.extension() == ".png"; }

}  // namespace

void require_drawing_file(const std::filesystem::path& file, bench::OutputRules rules) {
  if (!is_png(file) && file.extension() != ".svg")
    throw InputError(file.string(), "has no extension of a drawing; use one of: .svg, .png");
  rules.beginning = is_png(file) ? kPngBeginning : "<svg";
  bench::require_safe_output(file, rules);
}

void write_drawing(const std::filesystem::path& file, const Drawing& drawing, double scale,
                   bench::OutputRules rules) {
  require_drawing_file(file, rules);
  if (is_png(file)) return write_drawing_png(file, drawing, scale);
  rules.beginning = "<svg";
  bench::write_output(file, svg_text(drawing), rules);
}

}  // namespace stillpoint::report
