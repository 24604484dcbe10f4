// SPDX-License-Identifier: BSD-3-Clause
/// Drawings as SVG 1.1 text.
#pragma once

#include <string>

#include "reports/drawing.h"

namespace stillpoint {

/// A self-contained SVG document; coordinates with 2 decimals, so that equal drawings give equal bytes.
[[nodiscard]] std::string svg_text(const Drawing& drawing);

}  // namespace stillpoint
