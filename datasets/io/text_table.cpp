// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr std::string_view kSeparators = " \t\r,";
constexpr int kNanosecondDigits = 9;
constexpr int kMaxDigits = 19;  ///< always fits into uint64

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields;
  std::size_t begin = line.find_first_not_of(kSeparators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSeparators, end);
  }
  return fields;
}

/// The number 0.d1d2d3... * 10^exponent of an unsigned decimal text.
struct Decimal {
  std::string digits;
  long exponent = 0;
};

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal decimal;
  std::size_t at = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) decimal.digits += text[at];
  decimal.exponent = static_cast<long>(decimal.digits.size());
  if (at < text.size() && text[at] == '.') {
    for (++at; at < text.size() && is_digit(text[at]); ++at) decimal.digits += text[at];
  }
  if (decimal.digits.empty()) return std::nullopt;
  if (at == text.size()) return decimal;
  if (text[at] != 'e' && text[at] != 'E') return std::nullopt;
  if (++at < text.size() && text[at] == '+') ++at;
  int shift = 0;
  const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), shift);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  decimal.exponent += shift;
  return decimal;
}

}  // namespace

std::optional<Timestamp> parse_seconds(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  std::optional<Decimal> decimal = parse_decimal(text);
  if (!decimal) return std::nullopt;
  const std::size_t zeros = std::min(decimal->digits.find_first_not_of('0'), decimal->digits.size());
  decimal->digits.erase(0, zeros);
  const long digit_count = decimal->exponent - static_cast<long>(zeros) + kNanosecondDigits;
  if (decimal->digits.empty() || digit_count < 0) return Timestamp{0};
  if (digit_count > kMaxDigits) return std::nullopt;
  const auto count = static_cast<std::size_t>(digit_count);
  decimal->digits.resize(std::max(decimal->digits.size(), count + 1), '0');
  std::uint64_t ns = 0;
  for (std::size_t i = 0; i < count; ++i) ns = 10 * ns + static_cast<std::uint64_t>(decimal->digits[i] - '0');
  if (decimal->digits[count] >= '5') ++ns;
  if (ns > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return std::nullopt;
  return Timestamp{negative ? -static_cast<std::int64_t>(ns) : static_cast<std::int64_t>(ns)};
}

TextTable::TextTable(const std::filesystem::path& file) : file_(file.string()) {
  std::ifstream in(file, std::ios::binary);
  std::error_code ignored;
  if (!in || std::filesystem::is_directory(file, ignored)) {
    throw InputError(file_, "cannot be opened; is the sequence complete?");
  }
  std::string line;
  for (long number = 1; std::getline(in, line); ++number) {
    TextRow row{.line = number, .fields = split(line)};
    if (!row.fields.empty() && row.fields.front().front() != '#') rows_.push_back(std::move(row));
  }
  if (in.bad()) throw InputError(file_, "cannot be read completely; copy the file again");
}

const std::string& TextTable::text(const TextRow& row, std::size_t field) const {
  if (field < row.fields.size()) return row.fields[field];
  fail(row, "has " + std::to_string(row.fields.size()) + " field(s), expected at least " +
                std::to_string(field + 1));
}

double TextTable::number(const TextRow& row, std::size_t field) const {
  const std::string& found = text(row, field);
  const std::size_t sign = found.front() == '+' ? 1 : 0;
  const char* const last = found.data() + found.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(found.data() + sign, last, value);
  if (error != std::errc() || end != last) fail(row, "\"" + found + "\" is not a number");
  if (!std::isfinite(value)) fail(row, "\"" + found + "\" is not finite; remove the row");
  return value;
}

Timestamp TextTable::seconds(const TextRow& row, std::size_t field) const {
  const std::string& found = text(row, field);
  const std::optional<Timestamp> t = parse_seconds(found);
  if (!t) fail(row, "\"" + found + "\" is not a time in seconds");
  return *t;
}

Timestamp TextTable::nanoseconds(const TextRow& row, std::size_t field) const {
  const std::string& found = text(row, field);
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), ns);
  if (error != std::errc() || end != found.data() + found.size()) {
    fail(row, "\"" + found + "\" is not an integer time in nanoseconds");
  }
  return Timestamp{ns};
}

void TextTable::require_increasing(const TextRow& row, Timestamp previous, Timestamp now) const {
  if (now > previous) return;
  const std::string difference = std::to_string(seconds_between(now, previous));
  fail(row, now == previous ? "repeats the timestamp of the previous row; remove one of the two"
                            : "is " + difference + " s earlier than the previous row; sort the file by time");
}

void TextTable::fail(const TextRow& row, const std::string& problem) const {
  throw InputError(file_, row.line, problem);
}

void TextTable::fail(const std::string& problem) const { throw InputError(file_, problem); }

}  // namespace stillpoint::datasets
