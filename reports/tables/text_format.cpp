// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/text_format.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <system_error>

#include <fmt/format.h>

#include "bench/config/toml_source.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"

namespace stillpoint::report {
namespace {

constexpr std::uint32_t kReplacement = 0xFFFD;
/// Latin-1 characters that LaTeX's default fonts lack: multiplication, division, eth and thorn.
constexpr std::u32string_view kMissingInDefaultFonts = U"\u00D7\u00F7\u00D0\u00DE\u00F0\u00FE";

/// One code point and its length in bytes.
struct CodePoint {
  std::uint32_t value = kReplacement;
  std::size_t length = 1;
};

/// Smallest code point that needs `length` bytes; overlong encodings are invalid.
std::uint32_t smallest_code_point(std::size_t length) {
  return length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000;
}

CodePoint code_point_at(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >> 5 == 0x6 ? 2 : first >> 4 == 0xE ? 3 : first >> 3 == 0x1E ? 4 : 0;
  if (length == 0 || text.size() < length) return {};
  std::uint32_t value = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6 != 0x2) return {};
    value = value << 6 | (byte(i) & 0x3F);
  }
  const bool is_surrogate = value >= 0xD800 && value < 0xE000;
  if (value < smallest_code_point(length) || value > 0x10FFFF || is_surrogate) return {};
  return {value, length};
}

/// Calls `visit(code point, its bytes)` for each character of the sanitized text.
template <class Visit>
void for_each_character(std::string_view text, Visit&& visit) {
  while (!text.empty()) {
    const CodePoint point = code_point_at(text);
    const bool is_control = point.value < 0x20 || (point.value >= 0x7F && point.value < 0xA0);
    if (is_control) {
      visit(std::uint32_t{' '}, std::string_view(" "));
    } else {
      const bool is_invalid = point.value == kReplacement;
      visit(point.value, is_invalid ? std::string_view("\xEF\xBF\xBD") : text.substr(0, point.length));
    }
    text.remove_prefix(point.length);
  }
}

std::string_view latex_escape(std::uint32_t character) {
  switch (character) {
    case '\\':
      return "\\textbackslash{}";
    case '{':
      return "\\{";
    case '}':
      return "\\}";
    case '_':
      return "\\_";
    case '&':
      return "\\&";
    case '%':
      return "\\%";
    case '$':
      return "\\$";
    case '#':
      return "\\#";
    case '~':
      return "\\textasciitilde{}";
    case '^':
      return "\\textasciicircum{}";
    case '<':
      return "\\textless{}";
    case '>':
      return "\\textgreater{}";
    case '|':
      return "\\textbar{}";
    case '"':
      return "\\char34{}";
    case '[':
      return "{[}";
    case ']':
      return "{]}";
    default:
      return "";
  }
}

}  // namespace

std::string clean_line(std::string_view text) {
  std::string result;
  for_each_character(text, [&](std::uint32_t, std::string_view bytes) { result += bytes; });
  return result;
}

std::string escape_html(std::string_view text) {
  std::string result;
  for_each_character(text, [&](std::uint32_t character, std::string_view bytes) {
    switch (character) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += bytes;
    }
  });
  return result;
}

std::string escape_latex(std::string_view text) {
  std::string result;
  for_each_character(text, [&](std::uint32_t character, std::string_view bytes) {
    const bool is_latin1_letter = character >= 0xC0 && character <= 0xFF &&
                                  kMissingInDefaultFonts.find(character) == kMissingInDefaultFonts.npos;
    const std::string_view special = latex_escape(character);
    if (!special.empty()) {
      result += special;
    } else if (character < 0x80 || is_latin1_letter) {
      result += bytes;
    } else {
      result += fmt::format("\\texttt{{U+{:04X}}}", character);
    }
  });
  return result;
}

std::string escape_markdown(std::string_view text) {
  constexpr std::string_view kSpecial = "\\`*_{}[]<>|#!~$&";
  std::string result;
  for_each_character(text, [&](std::uint32_t character, std::string_view bytes) {
    if (character < 0x80 && kSpecial.find(static_cast<char>(character)) != std::string_view::npos)
      result += '\\';
    result += bytes;
  });
  return result;
}

std::string csv_field(std::string_view text) {
  std::string line = clean_line(text);
  if (!line.empty() && std::string_view("=+-@").find(line.front()) != std::string_view::npos) {
    line.insert(line.begin(), '\'');
  }
  if (line.find_first_of(",\"'") == std::string::npos) return line;
  std::string quoted(1, '"');
  for (const char character : line) {
    if (character == '"') quoted += '"';
    quoted += character;
  }
  quoted += '"';
  return quoted;
}

std::string json_for_script(const std::string& json) {
  std::string result;
  result.reserve(json.size());
  for (const char character : json) {
    if (character == '<') {
      result += "\\u003c";
    } else {
      result += character;
    }
  }
  return result;
}

std::string percent_text(double ratio) { return fmt::format("{:+.1f} %", 100.0 * ratio); }

std::string interval_text(const eval::RelativeChange& change) {
  if (!change.interval) return fmt::format("n = {}, no interval", change.count);
  return fmt::format("n = {}, {:+.1f} to {}", change.count, 100.0 * change.interval->low,
                     percent_text(change.interval->high));
}

namespace {

/// A number, which may begin with a sign, as it is; a text as `csv_field`.
std::string csv_cell(const std::string& cell) {
  const char* const begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  const bool is_number = error == std::errc{} && end == cell.data() + cell.size();
  return is_number ? cell : csv_field(cell);
}

/// A bar of a name would end its cell; those of `escape_markdown` are escaped.
TableRows with_escaped_bars(TableRows rows) {
  for (std::vector<std::string>& row : rows) {
    for (std::string& cell : row) {
      for (std::size_t bar = cell.find('|'); bar != std::string::npos; bar = cell.find('|', bar + 1)) {
        if (bar == 0 || cell[bar - 1] != '\\') cell.insert(bar++, 1, '\\');
      }
    }
  }
  return rows;
}

std::vector<std::size_t> widths_of(const TableRows& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 3);  // the Markdown delimiter row needs three dashes
  for (const std::vector<std::string>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

}  // namespace

std::string format_table(const TableRows& cells, TableStyle style) {
  std::string text;
  if (cells.empty()) return text;
  const TableRows rows = style == TableStyle::kMarkdown ? with_escaped_bars(cells) : cells;
  const std::vector<std::size_t> widths = widths_of(rows);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (style == TableStyle::kMarkdown) text += "| ";
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const std::string& cell = rows[r][i];
      if (i > 0) text += style == TableStyle::kCsv ? "," : style == TableStyle::kMarkdown ? " | " : "  ";
      text += style == TableStyle::kCsv ? csv_cell(cell) : cell;
      if (style != TableStyle::kCsv) text.append(widths[i] - cell.size(), ' ');
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    text += style == TableStyle::kMarkdown ? " |\n" : "\n";
    if (r > 0 || style != TableStyle::kMarkdown) continue;
    for (const std::size_t width : widths) {
      text += '|';
      text.append(width + 2, '-');
    }
    text += "|\n";
  }
  return text;
}

std::string_view web_file(std::string_view name) {
  constexpr std::string_view kRoot = "reports/web/";
  for (const bench::EmbeddedFile& file : bench::web_files()) {
    if (file.path.substr(kRoot.size()) == name) return file.text;
  }
  STILLPOINT_CHECK(false && "every requested file is listed in reports/CMakeLists.txt");
  return {};
}

std::string scripts_html(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) text += fmt::format("<script>\n{}</script>\n", web_file(name));
  return text;
}

std::string filled_template(std::string_view text, const TemplateParts& parts) {
  constexpr std::string_view kOpen = "<!--";
  constexpr std::string_view kClose = "-->";
  std::string result;
  while (true) {
    const std::size_t begin = text.find(kOpen);
    result += text.substr(0, begin);
    if (begin == std::string_view::npos) return result;
    const std::size_t end = text.find(kClose, begin);
    const auto found = parts.find(text.substr(begin + kOpen.size(), end - begin - kOpen.size()));
    if (found != parts.end()) result += found->second;
    text.remove_prefix(end + kClose.size());
  }
}

std::string preformatted(const std::string& text) {
  std::string result;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    result += escape_html(rest.substr(0, end)) + "\n";
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return result;
}

std::string html_table(const std::string& id, const std::string& caption,
                       const std::vector<ColumnHead>& heads, const std::string& rows) {
  std::string head;
  for (const ColumnHead& column : heads) {
    head += fmt::format("<th scope=\"col\"{}>{}</th>", column.is_text ? " class=\"text\"" : "", column.text);
  }
  return fmt::format(
      "<div class=\"table\"><table id=\"{}\">{}<thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>",
      id, caption.empty() ? "" : "<caption>" + caption + "</caption>", head, rows);
}

std::string metric_heading(const std::string& name) {
  const std::string tooltip = bench::tooltip_of(name);
  return fmt::format("<th scope=\"row\"{}>{}</th>",
                     tooltip.empty() ? "" : fmt::format(" title=\"{}\"", escape_html(tooltip)),
                     escape_html(name));
}

std::string glossary_html(const std::set<std::string>& names) {
  std::string items;
  for (const std::string& name : names) {
    const bench::MetricDescriptor* const metric = bench::find_metric(name);
    const std::string label = metric == nullptr ? "" : ", " + std::string(metric->label);
    if (const std::string text = bench::tooltip_of(name); !text.empty())
      items += "<dt>" + escape_html(name + label) + "</dt><dd>" + escape_html(text) + "</dd>\n";
  }
  return items.empty() ? ""
                       : "<details class=\"glossary\"><summary>What the metrics mean</summary><dl>\n" +
                             items + "</dl></details>\n";
}

std::string data_script(const std::string& id, const std::string& json) {
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, json_for_script(json));
}

}  // namespace stillpoint::report
