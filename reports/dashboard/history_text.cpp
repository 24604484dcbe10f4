// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/history_text.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "reports/tables/change_text.h"
#include "reports/tables/escaping.h"

namespace stillpoint::report {
namespace {

constexpr std::size_t kHashDigits = 10;
constexpr std::size_t kMaxCharacters = 24;

bool is_git_hash(const std::string& text) {
  return text.size() == 40 && std::all_of(text.begin(), text.end(),
                                          [](unsigned char letter) { return std::isxdigit(letter) != 0; });
}

/// The first `count` characters of valid UTF-8 text.
std::string first_characters(const std::string& text, std::size_t count) {
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    const bool starts_character = (static_cast<unsigned char>(text[end]) & 0xC0) != 0x80;
    if (starts_character && count-- == 0) return text.substr(0, end);
  }
  return text;
}

}  // namespace

std::string commit_label(const std::string& name) {
  const std::size_t plus = name.find('+');
  std::string base = name.substr(0, plus);
  if (is_git_hash(base)) base.resize(kHashDigits);
  return first_characters(clean_line(plus == std::string::npos ? base : base + name.substr(plus)),
                          kMaxCharacters);
}

std::string subject_label(const bench::HistorySubject& subject) {
  std::string label = clean_line(subject.variant) + " on " + clean_line(subject.sequence);
  if (!subject.axis.empty()) label += fmt::format(", {} = {}", clean_line(subject.axis), subject.axis_value);
  if (subject.seed != 1) label += fmt::format(", seed {}", subject.seed);
  if (subject.mode != "sequential") label += ", " + clean_line(subject.mode);
  if (subject.kind != "accuracy") label += ", " + clean_line(subject.kind);
  if (!subject.cores.empty()) label += ", cores " + clean_line(subject.cores);
  return label;
}

std::string change_label(const bench::LevelShift& shift) {
  return shift.change ? percent_text(shift.change->median) : "new";
}

std::string interval_label(const bench::LevelShift& shift) {
  return shift.change ? interval_text(*shift.change) : "";
}

std::string value_label(double value, const std::string& unit) {
  return fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", clean_line(unit));
}

}  // namespace stillpoint::report
