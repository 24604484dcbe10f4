// SPDX-License-Identifier: BSD-3-Clause
/// Names with a part of LaTeX's notation, as spans of plain text that figures draw one after the other.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::report {

/// A part of a line of text.
struct NameSpan {
  std::string text;    ///< UTF-8
  double scale = 1.0;  ///< of the size of the font
  double rise = 0.0;   ///< of the baseline, in sizes of the font of the line
};

/// Understands mathematics between dollar signs (indices `_1` and `_{ij}`, exponents, Greek letters and a few
/// symbols such as `\times`), `\textsc{}` (small capitals), `\textrm{}`, `\mathrm{}`, `\text{}`, and escaped
/// characters such as `\_`. An underscore outside of mathematics is one. Letters of mathematics are upright.
///
/// @return a single span with the unchanged text if it contains nothing of that, or anything else of LaTeX
[[nodiscard]] std::vector<NameSpan> name_spans(std::string_view text);

}  // namespace stillpoint::report
