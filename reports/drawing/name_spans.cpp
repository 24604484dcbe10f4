// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/name_spans.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

namespace stillpoint::report {
namespace {

// Of TeX's fonts: indices and exponents at 7 of 10 pt, lowered by 0.15 and raised by 0.41 em; small capitals.
constexpr double kScriptScale = 0.7;
constexpr double kIndexRise = -0.15;
constexpr double kExponentRise = 0.41;
constexpr double kSmallCapitalScale = 0.8;
constexpr int kMaxNameDepth = 8;

using NameSymbol = std::pair<std::string_view, std::string_view>;
constexpr auto kNameSymbols = std::to_array<NameSymbol>(
    {{"alpha", "α"},      {"beta", "β"},   {"gamma", "γ"},   {"delta", "δ"},  {"epsilon", "ϵ"},
     {"varepsilon", "ε"}, {"zeta", "ζ"},   {"eta", "η"},     {"theta", "θ"},  {"iota", "ι"},
     {"kappa", "κ"},      {"lambda", "λ"}, {"mu", "μ"},      {"nu", "ν"},     {"xi", "ξ"},
     {"pi", "π"},         {"rho", "ρ"},    {"sigma", "σ"},   {"tau", "τ"},    {"upsilon", "υ"},
     {"phi", "ϕ"},        {"varphi", "φ"}, {"chi", "χ"},     {"psi", "ψ"},    {"omega", "ω"},
     {"Gamma", "Γ"},      {"Delta", "Δ"},  {"Theta", "Θ"},   {"Lambda", "Λ"}, {"Xi", "Ξ"},
     {"Pi", "Π"},         {"Sigma", "Σ"},  {"Upsilon", "Υ"}, {"Phi", "Φ"},    {"Psi", "Ψ"},
     {"Omega", "Ω"},      {"times", "×"},  {"cdot", "·"},    {"pm", "±"},     {"circ", "∘"},
     {"infty", "∞"},      {"leq", "≤"},    {"geq", "≥"},     {"approx", "≈"}, {"to", "→"},
     {"ell", "ℓ"},        {"star", "⋆"},   {"dagger", "†"}});
constexpr auto kUprightCommands = std::to_array<std::string_view>({"textrm", "mathrm", "text", "textnormal"});

/// How the text at the current place is drawn.
struct SpanStyle {
  double scale = 1.0;
  double rise = 0.0;
  bool math = false;
  bool small_capitals = false;
};

/// A recursive-descent parser; `failed` if the text is not of the notation.
class NameParser {
 public:
  explicit NameParser(std::string_view text) : rest_(text) {}

  /// All of the text; nullopt if it contains anything else of LaTeX.
  std::optional<std::vector<NameSpan>> parse() {
    read_until('\0', {}, 0);
    if (failed_) return std::nullopt;
    return std::move(spans_);
  }

 private:
  void append(std::string_view text, const SpanStyle& style) {
    if (spans_.empty() || spans_.back().scale != style.scale || spans_.back().rise != style.rise)
      spans_.push_back({"", style.scale, style.rise});
    spans_.back().text += text;
  }

  void append_letter(char letter, SpanStyle style) {
    if (style.small_capitals && std::islower(static_cast<unsigned char>(letter)) != 0) {
      style.scale *= kSmallCapitalScale;
      letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    }
    append({&letter, 1}, style);
  }

  char take() {
    const char letter = rest_.front();
    rest_.remove_prefix(1);
    return letter;
  }

  /// Reads up to `end`, and over it; '\0': the end of the text.
  void read_until(char end, const SpanStyle& style, int depth) {
    failed_ = failed_ || depth > kMaxNameDepth;
    while (!failed_ && !rest_.empty() && rest_.front() != end) read_item(style, depth);
    failed_ = failed_ || rest_.empty() != (end == '\0');
    if (!failed_ && end != '\0') take();
  }

  void read_item(const SpanStyle& style, int depth) {
    const char letter = take();
    switch (letter) {
      case '\\':
        return read_command(style, depth);
      case '$': {
        failed_ = failed_ || style.math;  // `read_until` takes the sign at the end
        SpanStyle math = style;
        math.math = true;
        return read_until('$', math, depth + 1);
      }
      case '{':
        return read_until('}', style, depth + 1);
      case '}':
        failed_ = true;
        return;
      case '_':
      case '^':
        if (style.math) return read_script(letter, style, depth);
        break;
      case ' ':
        if (style.math) return;
        break;
      case '-':
        if (style.math) return append("−", style);
        break;
      default:
        break;
    }
    append_letter(letter, style);
    if ((static_cast<unsigned char>(letter) & 0xc0U) == 0xc0U) append_continuation(style);
  }

  /// The other bytes of a character of UTF-8, so that an argument is not a part of one.
  void append_continuation(const SpanStyle& style) {
    while (!rest_.empty() && (static_cast<unsigned char>(rest_.front()) & 0xc0U) == 0x80U)
      append_letter(take(), style);
  }

  void read_script(char kind, SpanStyle style, int depth) {
    style.rise += style.scale * (kind == '_' ? kIndexRise : kExponentRise);
    style.scale *= kScriptScale;
    read_argument(style, depth);
  }

  /// A group, a command or a letter.
  void read_argument(const SpanStyle& style, int depth) {
    failed_ = failed_ || rest_.empty() || rest_.front() == '$' || depth >= kMaxNameDepth;
    if (!failed_) read_item(style, depth + 1);
  }

  void read_command(SpanStyle style, int depth) {
    constexpr std::string_view kEscaped = "_%&#${} ";
    if (!rest_.empty() && kEscaped.find(rest_.front()) != kEscaped.npos) return append_letter(take(), style);
    std::size_t length = 0;
    while (length < rest_.size() && std::isalpha(static_cast<unsigned char>(rest_[length])) != 0) ++length;
    const std::string_view name = rest_.substr(0, length);
    rest_.remove_prefix(length);
    const auto symbol = std::ranges::find(kNameSymbols, name, &NameSymbol::first);
    if (symbol != kNameSymbols.end() && style.math) {
      while (!rest_.empty() && rest_.front() == ' ') take();
      return append(symbol->second, style);
    }
    const bool is_plain = std::ranges::find(kUprightCommands, name) != kUprightCommands.end();
    failed_ = failed_ || !(is_plain || name == "textsc") || rest_.empty() || rest_.front() != '{';
    if (failed_) return;
    style.math = false;
    style.small_capitals = style.small_capitals || name == "textsc";
    read_argument(style, depth);
  }

  std::string_view rest_;
  std::vector<NameSpan> spans_;
  bool failed_ = false;
};

}  // namespace

std::vector<NameSpan> name_spans(std::string_view text) {
  if (text.find_first_of("$\\") == text.npos) return {{std::string(text)}};
  return NameParser(text).parse().value_or(std::vector<NameSpan>{{std::string(text)}});
}

}  // namespace stillpoint::report
