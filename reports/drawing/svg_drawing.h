// SPDX-License-Identifier: BSD-3-Clause
/// Writes drawings as SVG 1.1 text.
#pragma once

#include <string>

#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// A self-contained SVG document. Coordinates have 2 decimals, so that equal drawings give equal bytes.
[[nodiscard]] std::string svg_text(const Drawing& drawing);

}  // namespace stillpoint::report
