// SPDX-License-Identifier: BSD-3-Clause
/// Any text made harmless for the format that it is put into: names come from people and files.
#pragma once

#include <string>
#include <string_view>

namespace stillpoint {

/// One line of valid UTF-8: bytes that are none become U+FFFD, control characters spaces.
[[nodiscard]] std::string clean_line(std::string_view text);

/// For HTML and XML text, and for attributes in either kind of quotes.
[[nodiscard]] std::string escape_html(std::string_view text);

/// For text in LaTeX. Letters beyond Latin-1 are written as their code points, because not every font has
/// them.
[[nodiscard]] std::string escape_latex(std::string_view text);

/// For a cell of a Markdown table; HTML in it stays text.
[[nodiscard]] std::string escape_markdown(std::string_view text);

/// A field of a CSV file (RFC 4180). Text that a spreadsheet would take for a formula begins with an
/// apostrophe.
[[nodiscard]] std::string csv_field(std::string_view text);

/// For JSON inside a script element: "<" is written as \u003c, so that nothing ends the element.
[[nodiscard]] std::string json_for_script(const std::string& json);

}  // namespace stillpoint
