// SPDX-License-Identifier: BSD-3-Clause
/// Blocks of text that tables and pages consist of: untrusted text (names from users and files) escaped for
/// each output format, relative changes, rows of cells as aligned text, Markdown or CSV, and HTML.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/statistics/rank_tests.h"

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

/// "+5.2 %" of the ratio 0.052.
[[nodiscard]] std::string percent_text(double ratio);

/// "n = 8, +4.1 to +6.0 %", or "n = 3, no interval" if the number of values does not support one.
[[nodiscard]] std::string interval_text(const eval::RelativeChange& change);

enum class TableStyle { kText, kMarkdown, kCsv };

/// The first row is the header. All rows have the same number of cells.
using TableRows = std::vector<std::vector<std::string>>;

[[nodiscard]] std::string format_table(const TableRows& cells, TableStyle style);

/// A file of reports/web, embedded in the binary: template, style sheet, script, library or license.
/// @param name relative to reports/web, e.g. "page.css"; must be listed in reports/CMakeLists.txt
[[nodiscard]] std::string_view web_file(std::string_view name);

/// Script elements with the files, in this order.
/// @param names see `web_file`
[[nodiscard]] std::string scripts_html(std::span<const std::string_view> names);

/// Texts by placeholder name.
using TemplateParts = std::map<std::string, std::string, std::less<>>;

/// Replaces each placeholder <!--NAME--> of a template; missing parts become empty.
[[nodiscard]] std::string filled_template(std::string_view text, const TemplateParts& parts);

/// Escapes text for a pre element; keeps the line breaks that `escape_html` would replace by spaces.
[[nodiscard]] std::string preformatted(const std::string& text);

/// Column heading.
struct ColumnHead {
  std::string text;
  bool is_text = false;  ///< cells contain text, not numbers
};

/// A table that scrolls horizontally where it is wider than the page. No argument is escaped.
/// @param id   letters, digits and "-" only
/// @param rows HTML of the table body
[[nodiscard]] std::string html_table(const std::string& id, const std::string& caption,
                                     const std::vector<ColumnHead>& heads, const std::string& rows);

/// Row heading with the name of a metric or module, and its description as a tooltip.
[[nodiscard]] std::string metric_heading(const std::string& name);

/// Collapsed list of metrics and modules with their descriptions; names without one are omitted.
[[nodiscard]] std::string glossary_html(const std::set<std::string>& names);

/// A script element with JSON, looked up by id.
[[nodiscard]] std::string data_script(const std::string& id, const std::string& json);

}  // namespace stillpoint::report
