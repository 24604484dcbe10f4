// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/escaping.h"

#include <cstdint>

#include <fmt/format.h>

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

}  // namespace stillpoint::report
