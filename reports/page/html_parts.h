// SPDX-License-Identifier: BSD-3-Clause
/// The parts that every page is put together from.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// Texts by the names under which a template has them.
using TemplateParts = std::map<std::string, std::string, std::less<>>;

/// Replaces each <!--NAME--> of a template; a part that is not there is empty.
[[nodiscard]] std::string filled_template(std::string_view text, const TemplateParts& parts);

/// For a pre element, which keeps the lines that `escape_html` makes spaces.
[[nodiscard]] std::string preformatted(const std::string& text);

/// Heading of a column.
struct ColumnHead {
  std::string text;
  bool is_text = false;  ///< its cells are words, not numbers
};

/// A table that scrolls by itself where it is wider than the page; its texts are put in as they are.
/// @param id of harmless letters
/// @param rows the rows of its body
[[nodiscard]] std::string html_table(const std::string& id, const std::string& caption,
                                     const std::vector<ColumnHead>& heads, const std::string& rows);

/// JSON that scripts find by its id.
[[nodiscard]] std::string data_script(const std::string& id, const std::string& json);

}  // namespace stillpoint
