// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/column_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <utility>

#include "core/base/error.h"

namespace stillpoint::eval {
namespace {

constexpr std::string_view kAxes = "xyzw";
constexpr std::int64_t kSecond_ns = 1'000'000'000;

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

template <std::size_t kCount>
bool is_one_of(std::string_view text, const std::array<std::string_view, kCount>& candidates) {
  return std::find(candidates.begin(), candidates.end(), text) != candidates.end();
}

/// The words of a header line: between commas or semicolons if there are any, else between blanks that are
/// not in brackets; a word in brackets belongs to the one in front of it.
std::vector<std::string> words_of(std::string_view line) {
  const bool delimited = line.find_first_of(",;") != std::string_view::npos;
  std::vector<std::string> words{""};
  int depth = 0;
  for (const char letter : line) {
    const bool is_blank = letter == ' ' || letter == '\t' || letter == '\r';
    depth += letter == '[' || letter == '(' ? 1 : 0;
    depth -= letter == ']' || letter == ')' ? 1 : 0;
    const bool ends_word = delimited ? letter == ',' || letter == ';' : is_blank && depth == 0;
    if (ends_word) {
      if (delimited || !words.back().empty()) words.emplace_back();
    } else if (letter != '"' && letter != '\r') {
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
  }
  if (words.back().find_first_not_of(" \t") == std::string::npos) words.pop_back();
  return words;
}

std::string trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(" \t") - begin + 1));
}

std::vector<TableHeader::Column> columns_of_line(std::string_view line) {
  std::vector<TableHeader::Column> columns;
  for (const std::string& word : words_of(line)) {
    const std::size_t bracket = word.find_first_of("[(");
    const std::string name = trimmed(std::string_view(word).substr(0, bracket));
    std::string unit;
    if (bracket != std::string::npos) {
      const std::size_t end = std::min(word.find_first_of("])", bracket), word.size());
      unit = trimmed(std::string_view(word).substr(bracket + 1, end - bracket - 1));
    }
    if (name.empty() && !unit.empty() && !columns.empty() && columns.back().unit.empty()) {
      columns.back().unit = unit;
    } else {
      columns.push_back({name, unit});
    }
  }
  return columns;
}

/// Whether a line without "#" in front of it has words only.
bool has_no_number(const std::vector<TableHeader::Column>& columns) {
  return std::none_of(columns.begin(), columns.end(), [](const TableHeader::Column& column) {
    return !column.name.empty() && (parse_number(column.name) || contains(column.name, ":"));
  });
}

bool is_time(std::string_view name) {
  constexpr std::array<std::string_view, 10> kNames{"t",    "ts",      "t_s", "t_ns", "sec",
                                                    "secs", "seconds", "ns",  "nsec", "nanoseconds"};
  return is_one_of(name, kNames) || contains(name, "stamp") || name.starts_with("time") ||
         name.ends_with("time");
}

/// The axis that the name of a column ends with, and the rest of the name.
struct AxisName {
  std::size_t axis = 0;
  std::string_view rest;
};

std::optional<AxisName> axis_name(std::string_view name) {
  if (name.empty() || name.ends_with("yaw")) return std::nullopt;
  const std::size_t axis = kAxes.find(name.back());
  if (axis == std::string_view::npos) return std::nullopt;
  name.remove_suffix(1);
  while (!name.empty() && contains("_.-/ ", name.substr(name.size() - 1))) name.remove_suffix(1);
  return AxisName{axis, name};
}

bool is_quantity(std::string_view rest, Quantity quantity) {
  constexpr std::array<std::string_view, 7> kPosition{"", "t", "p", "pos", "trans", "loc", "location"};
  constexpr std::array<std::string_view, 7> kRate{"w", "g", "omega", "gyr", "gyro", "angvel", "rotrate"};
  const bool is_rate = is_one_of(rest, kRate) || rest.starts_with("w_") || rest.starts_with("g_") ||
                       rest.starts_with("gyr") || rest.starts_with("omega") ||
                       contains(rest, "angular_vel") || contains(rest, "rotation_rate");
  switch (quantity) {
    case Quantity::kPosition:
      return is_one_of(rest, kPosition) || rest.starts_with("p_") || rest.starts_with("t_") ||
             rest.starts_with("pos_") || contains(rest, "position") || contains(rest, "translation");
    case Quantity::kQuaternion:
      return !is_rate && (rest == "q" || rest == "r" || rest == "rot" || rest.starts_with("q_") ||
                          rest.starts_with("quat") || contains(rest, "orientation") ||
                          contains(rest, "quaternion") || contains(rest, "rotation"));
    case Quantity::kAngularVelocity:
      return is_rate;
    case Quantity::kAcceleration:
      return rest == "a" || rest.starts_with("a_") || rest.starts_with("acc") ||
             contains(rest, "linear_acc") || contains(rest, "acceleration");
  }
  return false;
}

bool names_samples(const TableHeader& header) {
  return time_columns(header) && (!columns_of(header, Quantity::kPosition).empty() ||
                                  !columns_of(header, Quantity::kAngularVelocity).empty());
}

}  // namespace

TableHeader find_header(std::string_view text) {
  TableHeader header;
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::size_t begin = line->find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) continue;
    const char first = (*line)[begin];
    const bool is_comment = first == '#';
    const bool has_mark = is_comment || first == '%';
    TableHeader read{lines.line_number(), is_comment,
                     columns_of_line(line->substr(begin + (has_mark ? 1 : 0)))};
    if (is_comment) {
      if (names_samples(read)) header = std::move(read);
      continue;
    }
    if (read.columns.size() >= 2 && has_no_number(read.columns)) header = std::move(read);
    break;
  }
  return header;
}

namespace {

/// A name without the word for seconds, or for parts of a second, that it ends with.
struct TimeName {
  std::string_view stem;
  std::int64_t unit_ns = 0;
};

std::optional<TimeName> time_name(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::int64_t>, 13> kEndings{{{"nanoseconds", 1},
                                                                                {"nanosecs", 1},
                                                                                {"nanosec", 1},
                                                                                {"nsecs", 1},
                                                                                {"nsec", 1},
                                                                                {"microseconds", 1000},
                                                                                {"microsecs", 1000},
                                                                                {"microsec", 1000},
                                                                                {"usecs", 1000},
                                                                                {"usec", 1000},
                                                                                {"seconds", kSecond_ns},
                                                                                {"secs", kSecond_ns},
                                                                                {"sec", kSecond_ns}}};
  for (const auto& [ending, unit_ns] : kEndings) {
    if (name.ends_with(ending)) return TimeName{name.substr(0, name.size() - ending.size()), unit_ns};
  }
  return std::nullopt;
}

/// Two columns of equal names but for the unit, of which one is of seconds.
/// @param require_header whether the names contain "header"
std::optional<TimeColumns> split_time_columns(const TableHeader& header, bool require_header) {
  for (std::size_t i = 0; i < header.columns.size(); ++i) {
    const std::string& name = header.columns[i].name;
    const std::optional<TimeName> seconds = time_name(name);
    if (!seconds || (!is_time(name) && seconds->stem != "tv_") || seconds->unit_ns != kSecond_ns) continue;
    if (require_header && !contains(seconds->stem, "header")) continue;
    for (std::size_t k = 0; k < header.columns.size(); ++k) {
      const std::optional<TimeName> rest = time_name(header.columns[k].name);
      if (rest && rest->unit_ns < kSecond_ns && rest->stem == seconds->stem)
        return TimeColumns{.stamp = i, .rest = k, .rest_unit_ns = rest->unit_ns};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<TimeColumns> time_columns(const TableHeader& header) {
  for (const bool require_header : {true, false}) {
    if (const auto split = split_time_columns(header, require_header)) return split;
  }
  std::optional<std::size_t> first;
  std::optional<std::size_t> of_header;
  bool has_seconds = false;
  bool has_rest = false;
  for (std::size_t i = 0; i < header.columns.size(); ++i) {
    const std::string& name = header.columns[i].name;
    const std::optional<TimeName> time = time_name(name);
    const bool is_rest = time && time->unit_ns == 1;
    if (!is_rest && !is_time(name)) continue;
    (is_rest ? has_rest : has_seconds) = true;
    if (!first) first = i;
    if (!of_header && contains(name, "header")) of_header = i;
  }
  if (!first || (has_seconds && has_rest)) return std::nullopt;
  return TimeColumns{.stamp = of_header.value_or(*first), .rest = std::nullopt};
}

Timestamp stamp_of(const TextRow& row, const TimeColumns& columns, TimeUnit unit) {
  if (!columns.rest) return row.time(columns.stamp, unit);
  const Timestamp seconds = row.time(columns.stamp, TimeUnit::kSeconds);
  if (seconds.ns % kSecond_ns != 0)
    throw row.error("\"" + std::string(row.text(columns.stamp)) +
                    "\" is no whole number of seconds, although the header names a column of the rest");
  if (seconds.ns > std::numeric_limits<std::int64_t>::max() - kSecond_ns)
    throw row.error("stamp \"" + std::string(row.text(columns.stamp)) + "\" exceeds 292 years");
  const std::string found(row.text(*columns.rest));
  const std::optional<Timestamp> rest = parse_nanoseconds(found);  // an integer of either unit
  const std::int64_t most = kSecond_ns / columns.rest_unit_ns - 1;
  if (!rest || rest->ns < 0 || rest->ns > most)
    throw row.error("\"" + found + "\" is no integer from 0 to " + std::to_string(most) +
                    ", the rest of a stamp after its whole seconds");
  return {seconds.ns + rest->ns * columns.rest_unit_ns};
}

std::optional<TimeUnit> time_unit(const TableHeader& header, std::string_view file) {
  const std::optional<TimeColumns> columns = time_columns(header);
  if (!columns) return std::nullopt;
  if (columns->rest) return TimeUnit::kSeconds;
  const auto& [name, unit] = header.columns[columns->stamp];
  const std::string_view word =
      unit.empty() ? std::string_view(name).substr(name.find_last_of("_.-/ ") + 1) : std::string_view(unit);
  const auto is = [word](const std::string& prefix, std::string_view letters) {
    return word == letters || word.starts_with(std::string(letters) + "ec") || word.starts_with(prefix);
  };
  if (is("nano", "ns")) return TimeUnit::kNanoseconds;
  if (word == "s" || word.starts_with("sec")) return TimeUnit::kSeconds;
  if (is("mic", "us") || is("mil", "ms")) {
    throw InputError(std::string(file), header.line,
                     "the stamps are in " + (unit.empty() ? name : unit) + "; convert them to s or ns");
  }
  return std::nullopt;
}

std::vector<std::size_t> columns_of(const TableHeader& header, Quantity quantity) {
  const std::size_t count = quantity == Quantity::kQuaternion ? 4 : 3;
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> found(count, kNone);
  for (std::size_t i = 0; i < header.columns.size(); ++i) {
    const std::optional<AxisName> name = axis_name(header.columns[i].name);
    if (!name || name->axis >= count || !is_quantity(name->rest, quantity)) continue;
    if (found[name->axis] != kNone) return {};
    found[name->axis] = i;
  }
  if (std::find(found.begin(), found.end(), kNone) != found.end()) return {};
  return found;
}

bool names_euler_angles(const TableHeader& header) {
  constexpr std::array<std::string_view, 3> kAngles{"roll", "pitch", "yaw"};
  return std::ranges::all_of(kAngles, [&header](std::string_view angle) {
    return std::ranges::any_of(header.columns, [angle](const TableHeader::Column& column) {
      return std::string_view(column.name).ends_with(angle);
    });
  });
}

std::string unit_of(const TableHeader& header, Quantity quantity) {
  const std::vector<std::size_t> columns = columns_of(header, quantity);
  return columns.empty() ? "" : header.columns[columns.front()].unit;
}

bool fits_rows(const TableHeader& header, std::string_view text) {
  RowReader rows(text, "");
  while (const std::optional<TextRow> row = rows.next()) {
    if (row->line > header.line)
      return row->fields.size() == header.columns.size() ||
             (!header.columns.empty() && is_time(header.columns.front().name));
  }
  return false;
}

}  // namespace stillpoint::eval
