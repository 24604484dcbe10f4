// SPDX-License-Identifier: BSD-3-Clause
/// Escapes untrusted text (names from users and files) for each output format.
#pragma once

#include <string>
#include <string_view>

namespace stillpoint::report {

/// One line of valid UTF-8: invalid bytes become U+FFFD, control characters become spaces.
[[nodiscard]] std::string clean_line(std::string_view text);

/// For HTML and XML text and for attributes in single or double quotes.
[[nodiscard]] std::string escape_html(std::string_view text);

/// For text in LaTeX. Characters outside Latin-1 are written as code points because the default fonts lack
/// them.
[[nodiscard]] std::string escape_latex(std::string_view text);

/// For a cell of a Markdown table; also neutralizes HTML.
[[nodiscard]] std::string escape_markdown(std::string_view text);

/// A field of a CSV file (RFC 4180). An apostrophe is prepended to text that a spreadsheet would interpret as
/// a formula.
[[nodiscard]] std::string csv_field(std::string_view text);

/// For JSON inside a script element: "<" is written as \u003c so that no text can close the element.
[[nodiscard]] std::string json_for_script(const std::string& json);

}  // namespace stillpoint::report
