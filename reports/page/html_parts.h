// SPDX-License-Identifier: BSD-3-Clause
/// HTML building blocks shared by all pages.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::report {

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

/// "1 run", "2 runs".
[[nodiscard]] std::string counted(std::size_t count, const std::string& noun);

/// Collapsed list of metrics and modules with their descriptions; names without one are omitted.
[[nodiscard]] std::string glossary_html(const std::set<std::string>& names);

/// A script element with JSON, looked up by id.
[[nodiscard]] std::string data_script(const std::string& id, const std::string& json);

}  // namespace stillpoint::report
