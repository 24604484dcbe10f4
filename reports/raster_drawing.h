// SPDX-License-Identifier: BSD-3-Clause
/// Drawings as pixels, by OpenCV: it has lines, discs and stroke fonts.
#pragma once

#include <filesystem>

#include "reports/drawing.h"

namespace stillpoint {

/// Writes a PNG of `scale` pixels per unit of the drawing, antialiased.
/// @throws InputError if the file cannot be written
void write_drawing_png(const std::filesystem::path& file, const Drawing& drawing, double scale);

}  // namespace stillpoint
