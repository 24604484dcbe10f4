// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/text_table.h"

#include <cmath>

namespace stillpoint::eval {
namespace {

constexpr std::string_view kSeparators = " \t,\r";

std::string quoted(std::string_view field) {
  constexpr std::size_t kMaxLength = 40;
  return "\"" + std::string(field.substr(0, kMaxLength)) + (field.size() > kMaxLength ? "...\"" : "\"");
}

}  // namespace

std::string_view TextRow::text(std::size_t field) const {
  if (field < fields.size()) return fields[field];
  throw error("has " + std::to_string(fields.size()) + " field(s), expected at least " +
              std::to_string(field + 1));
}

double TextRow::number(std::size_t field) const {
  const std::string_view found = text(field);
  const std::optional<double> value = parse_number(found);
  if (!value) throw error(quoted(found) + " is not a number");
  return *value;
}

double TextRow::finite_number(std::size_t field) const {
  const double value = number(field);
  if (!std::isfinite(value)) throw error(quoted(fields[field]) + " is not finite; remove the row");
  return value;
}

Timestamp TextRow::time(std::size_t field, TimeUnit unit) const {
  const std::string_view found = text(field);
  const std::optional<Timestamp> t =
      unit == TimeUnit::kSeconds ? parse_stamp(found) : parse_nanoseconds(found);
  if (t) return *t;
  if (unit == TimeUnit::kNanoseconds) {
    throw error("stamp " + quoted(found) +
                " is not an integer number of nanoseconds; is the file in seconds?");
  }
  if (parse_number(found).value_or(0.0) > 1.0) {
    throw error("stamp " + quoted(found) + " exceeds 292 years; is it in nanoseconds instead of seconds?");
  }
  throw error("stamp " + quoted(found) + " is not a number of seconds");
}

void TextRow::require_increasing(Timestamp previous, Timestamp now) const {
  if (now > previous) return;
  if (now == previous) {
    throw error("stamp " + format_stamp(now) + " s repeats that of the previous row; remove one of the two");
  }
  throw error("stamp " + format_stamp(now) + " s is " + std::to_string(seconds_between(now, previous)) +
              " s earlier than the previous row; sort the file by time");
}

InputError TextRow::error(const std::string& problem) const { return {std::string(file), line, problem}; }

std::optional<TextRow> RowReader::next() {
  while (const std::optional<std::string_view> line = lines_.next()) {
    fields_.clear();
    std::size_t begin = line->find_first_not_of(kSeparators);
    if (begin == std::string_view::npos || (*line)[begin] == '#') continue;
    while (begin != std::string_view::npos) {
      const std::size_t end = line->find_first_of(kSeparators, begin);
      fields_.push_back(line->substr(begin, end - begin));
      begin = line->find_first_not_of(kSeparators, end);
    }
    return TextRow{.file = file_, .line = lines_.line_number(), .content = *line, .fields = fields_};
  }
  return std::nullopt;
}

}  // namespace stillpoint::eval
