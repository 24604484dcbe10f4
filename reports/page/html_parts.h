// SPDX-License-Identifier: BSD-3-Clause
/// HTML building blocks shared by all pages.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::report {

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

/// A script element with JSON, looked up by id.
[[nodiscard]] std::string data_script(const std::string& id, const std::string& json);

}  // namespace stillpoint::report
