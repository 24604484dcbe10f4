// SPDX-License-Identifier: BSD-3-Clause
/// Rasterizes drawings with OpenCV.
#pragma once

#include <filesystem>

#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// Writes a PNG of `scale` pixels per unit of the drawing, antialiased.
/// @throws InputError if the file cannot be written
void write_drawing_png(const std::filesystem::path& file, const Drawing& drawing, double scale);

}  // namespace stillpoint::report
