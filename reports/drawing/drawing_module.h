// SPDX-License-Identifier: BSD-3-Clause
/// cairo and pango behind function pointers, in a module of its own (datasets/io/shared_module.h).
#pragma once

#include <span>
#include <string>

#include "reports/drawing/drawing.h"

namespace stillpoint::report {

struct DrawingModule {
  std::string (*pdf)(std::span<const Drawing> pages, const char* fonts);
  /// Empty if the image would have more than 32767 rows or columns.
  std::string (*png)(const Drawing& drawing, double scale, const char* fonts);
  double (*text_width)(const std::string& text, double size, const char* fonts);
};

/// The module, loaded at the first call; null in a build without it.
/// @throws InputError if it is not installed
[[nodiscard]] const DrawingModule* drawing_module();

}  // namespace stillpoint::report
