// SPDX-License-Identifier: BSD-3-Clause
/// Drawings as files whose extension selects the format.
#pragma once

#include <filesystem>

#include "bench/record/output_folder.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// Checks a file name before the work begins: its extension, and what it would replace.
/// @param rules without `beginning`, which the format determines
/// @throws InputError if the extension is not .svg, .pdf or .png, or as bench::require_safe_output
void require_drawing_file(const std::filesystem::path& file, bench::OutputRules rules);

/// Checks as `require_drawing_file`, and writes an SVG or PDF, or a PNG of `scale` pixels per unit of the
/// drawing.
/// @throws InputError in addition if the file cannot be written
void write_drawing(const std::filesystem::path& file, const Drawing& drawing, double scale,
                   bench::OutputRules rules);

}  // namespace stillpoint::report
