// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/text_reader.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/system_resources.h"

namespace stillpoint::eval {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";        // some editors write it at the start of a file
constexpr std::uint64_t kMaxBytes = std::uint64_t{4} << 30U;  // a day of IMU samples at 400 Hz has 3 GB
constexpr std::size_t kBlockBytes = std::size_t{1} << 20U;
constexpr int kStampDecimals = 9;
constexpr int kMaxExponent = 64;

/// A decimal number: its digits, with the decimal point after the first `point` of them.
struct Decimal {
  bool negative = false;
  std::string digits;
  int point = 0;
};

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

std::string_view without_plus(std::string_view field) {
  return field.size() > 1 && field[0] == '+' && field[1] != '-' ? field.substr(1) : field;
}

std::optional<int> parse_exponent(std::string_view text) {
  text = without_plus(text);
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (exponent < -kMaxExponent || exponent > kMaxExponent) return std::nullopt;
  return exponent;
}

std::optional<Decimal> parse_decimal(std::string_view field) {
  Decimal decimal;
  field = without_plus(field);
  if (!field.empty() && field.front() == '-') {
    decimal.negative = true;
    field.remove_prefix(1);
  }
  bool after_point = false;
  std::size_t i = 0;
  for (; i < field.size(); ++i) {
    if (field[i] == '.' && !after_point) {
      after_point = true;
    } else if (field[i] >= '0' && field[i] <= '9') {
      decimal.digits.push_back(field[i]);
      if (!after_point) ++decimal.point;
    } else {
      break;
    }
  }
  if (decimal.digits.empty()) return std::nullopt;
  if (i == field.size()) return decimal;
  if (field[i] != 'e' && field[i] != 'E') return std::nullopt;
  const std::optional<int> exponent = parse_exponent(field.substr(i + 1));
  if (!exponent) return std::nullopt;
  decimal.point += *exponent;
  return decimal;
}

}  // namespace

namespace {

struct OpenFile {
  std::ifstream stream;
  std::uint64_t bytes = 0;
};

/// The file, to be read from its beginning.
OpenFile open_text(const std::filesystem::path& file) {
  require_regular_file(file);
  errno = 0;
  OpenFile opened{std::ifstream(file, std::ios::binary | std::ios::ate)};
  if (!opened.stream) {
    require_resources(errno, file.string());
    throw InputError(file.string(), "cannot be opened; check the path and the permissions");
  }
  opened.bytes = static_cast<std::uint64_t>(opened.stream.tellg());
  if (opened.bytes > kMaxBytes) throw InputError(file.string(), "is larger than 4 GB; expected a text file");
  opened.stream.seekg(0);
  return opened;
}

/// `text` with the next bytes of the file behind it.
std::string with_bytes(std::string text, std::ifstream& stream, std::size_t bytes, const std::string& name) {
  const std::size_t known = text.size();
  text.resize(known + bytes);
  stream.read(text.data() + known, static_cast<std::streamsize>(bytes));
  if (!stream) throw InputError(name, "cannot be read completely; the file or the disk may be damaged");
  return text;
}

/// Length of the byte order mark at the start of a file.
/// @throws InputError if it is no UTF-8 text
std::size_t mark_length(std::string_view start, const std::string& name) {
  if (start.starts_with("version https://git-lfs"))
    throw InputError(name, "is a pointer of Git LFS, not the file; run `git lfs pull`");
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF"))
    throw InputError(name, "is UTF-16 text; convert it to UTF-8, e.g. with `iconv -f UTF-16 -t UTF-8`");
  return start.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0;
}

/// Why the first bytes of a file are those of no text; empty if they may be.
std::string problem_of_start(std::string_view bytes) {
  constexpr std::array<std::pair<std::string_view, const char*>, 5> kCompressed{
      {{"\x1F\x8B", "gunzip"},
       {"PK\x03\x04", "unzip"},
       {"\xFD\x37zXZ", "unxz"},
       {"\x28\xB5\x2F\xFD", "unzstd"},
       {"BZh", "bunzip2"}}};
  for (const auto& [magic, tool] : kCompressed) {
    if (bytes.starts_with(magic))
      return std::string("is compressed; decompress it, e.g. with `") + tool + "`";
  }
  return "";
}

/// Why bytes of a file are no text; empty if they may be one.
std::string problem_of_bytes(std::string_view bytes) {
  if (bytes.find('\0') == std::string_view::npos) return "";
  return "contains NUL bytes: it is binary, damaged, or UTF-16 text without its mark; expected UTF-8 text";
}

/// Whether a text contains the header of a table and a row.
bool has_two_records(std::string_view text) {
  RowReader rows(text, "");
  return rows.next() && rows.next();
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file) {
  OpenFile opened = open_text(file);
  std::string text = with_bytes({}, opened.stream, opened.bytes, file.string());
  text.erase(0, mark_length(text, file.string()));
  return text;
}

TextBlocks::TextBlocks(const std::filesystem::path& file) : name_(file.string()) {
  OpenFile opened = open_text(file);
  stream_ = std::move(opened.stream);
  unread_ = opened.bytes;
  read_more();
  begin_ = mark_length(buffer_, name_);
  for (const std::string& problem : {problem_of_start(buffer_), problem_of_bytes(buffer_)})
    if (!problem.empty()) throw InputError(name_, problem);
  while (!has_two_records(block()) && unread_ > 0) read_more();
}

std::size_t TextBlocks::estimated_lines() const {
  constexpr double kMargin = 1.05;
  constexpr double kMinLineBytes = 32.0;
  const std::string_view text = block();
  if (text.empty()) return 0;
  const auto lines = static_cast<double>(1 + std::count(text.begin(), text.end(), '\n'));
  const double bytes = static_cast<double>(buffer_.size()) + static_cast<double>(unread_);
  return static_cast<std::size_t>(
      std::min(bytes / kMinLineBytes, kMargin * lines * bytes / static_cast<double>(text.size())));
}

void TextBlocks::read_more() {
  do {
    const std::size_t bytes = std::min<std::uint64_t>(unread_, kBlockBytes);
    buffer_ = with_bytes(std::move(buffer_), stream_, bytes, name_);
    unread_ -= bytes;
    const std::size_t last = buffer_.rfind('\n');
    end_ = unread_ == 0 ? buffer_.size() : last == std::string::npos ? 0 : last + 1;
  } while (end_ == 0 && unread_ > 0);
}

void TextBlocks::advance() {
  buffer_.erase(0, end_);
  begin_ = end_ = 0;
  read_more();
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
  const std::filesystem::path partial = file.string() + ".partial-" + std::to_string(::getpid());
  std::ofstream stream(partial, std::ios::binary | std::ios::trunc);
  if (!stream) throw InputError(file.string(), "cannot be created; check the path and the permissions");
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(partial, file, error);
  if (!stream || error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw InputError(file.string(), "cannot be written; check for a full disk or a read-only folder");
  }
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty() && blocks_ != nullptr) {
    blocks_->advance();
    rest_ = blocks_->block();
  }
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  ++line_number_;
  return line;
}

std::optional<double> parse_number(std::string_view field) {
  field = without_plus(field);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

namespace {

/// A stamp as files have it: up to 10 digits, below 9e9 s, and up to 9 decimals; nullopt for other text.
std::optional<Timestamp> parse_common_stamp(std::string_view field) {
  constexpr std::size_t kMaxDigits = 10;
  constexpr std::int64_t kMaxSeconds = 9'000'000'000;
  const bool negative = field.starts_with('-');
  if (negative) field.remove_prefix(1);
  const auto is_digit_at = [&](std::size_t i) { return i < field.size() && is_digit(field[i]); };
  std::int64_t ns = 0;
  std::size_t i = 0;
  for (; is_digit_at(i); ++i) {
    if (i == kMaxDigits) return std::nullopt;
    ns = 10 * ns + (field[i] - '0');
  }
  if (i == 0 || ns > kMaxSeconds) return std::nullopt;
  if (i < field.size() && field[i] == '.') ++i;
  int decimals = 0;
  for (; is_digit_at(i); ++i, ++decimals) {
    if (decimals == kStampDecimals) return std::nullopt;
    ns = 10 * ns + (field[i] - '0');
  }
  if (i != field.size()) return std::nullopt;
  for (; decimals < kStampDecimals; ++decimals) ns *= 10;
  return Timestamp{negative ? -ns : ns};
}

}  // namespace

std::optional<Timestamp> parse_stamp(std::string_view field) {
  if (const std::optional<Timestamp> t = parse_common_stamp(field)) return t;
  std::optional<Decimal> decimal = parse_decimal(field);
  if (!decimal) return std::nullopt;
  constexpr std::int64_t kLimit = std::numeric_limits<std::int64_t>::max() / 10 - 1;
  const int digit_count = decimal->point + kStampDecimals;  // digits down to the nanosecond
  std::int64_t ns = 0;
  for (int i = 0; i < digit_count; ++i) {
    const bool beyond = static_cast<std::size_t>(i) >= decimal->digits.size();
    if (ns > kLimit) return std::nullopt;
    ns = 10 * ns + (beyond ? 0 : decimal->digits[static_cast<std::size_t>(i)] - '0');
  }
  if (digit_count >= 0 && static_cast<std::size_t>(digit_count) < decimal->digits.size() &&
      decimal->digits[static_cast<std::size_t>(digit_count)] >= '5') {
    ++ns;
  }
  return Timestamp{decimal->negative ? -ns : ns};
}

std::optional<Timestamp> parse_nanoseconds(std::string_view field) {
  field = without_plus(field);
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), ns);
  if (error != std::errc()) return std::nullopt;
  const std::string_view decimals(end, static_cast<std::size_t>(field.data() + field.size() - end));
  const bool is_integer = decimals.empty() || (decimals.front() == '.' &&
                                               decimals.find_first_not_of('0', 1) == std::string_view::npos);
  return is_integer ? std::optional(Timestamp{ns}) : std::nullopt;
}

std::string format_stamp(Timestamp t) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  const bool negative = t.ns < 0;
  const std::int64_t seconds = t.ns / kNsPerSecond;
  const std::int64_t rest = t.ns % kNsPerSecond;
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%s%lld.%09lld", negative ? "-" : "",
                static_cast<long long>(negative ? -seconds : seconds),
                static_cast<long long>(negative ? -rest : rest));
  return buffer;
}

namespace {

constexpr std::string_view kSeparators = " \t\r,;";

bool is_delimiter(char letter) { return letter == ',' || letter == ';'; }

bool is_blank(char letter) { return letter == ' ' || letter == '\t' || letter == '\r'; }

/// The fields of a line, appended to `fields`. A delimiter at the end of the line begins no field.
std::vector<std::string_view> split_fields(std::string_view line, std::vector<std::string_view> fields) {
  const auto after_blanks = [line](std::size_t i) {
    while (i < line.size() && is_blank(line[i])) ++i;
    return i;
  };
  std::size_t begin = after_blanks(0);
  while (begin < line.size()) {
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end]) && !is_delimiter(line[end])) ++end;
    fields.push_back(line.substr(begin, end - begin));
    begin = after_blanks(end);
    if (begin < line.size() && is_delimiter(line[begin])) begin = after_blanks(begin + 1);
  }
  return fields;
}

/// Whether text follows a carriage return, as in files of several lines without a line feed.
bool has_inner_return(std::string_view line) {
  const std::size_t found = line.find('\r');
  return found != std::string_view::npos &&
         line.find_first_not_of(kSeparators, found) != std::string_view::npos;
}

/// "3,14": digits on both sides of the only comma, and no decimal point.
bool has_decimal_comma(std::string_view word) {
  const std::size_t comma = word.find(',');
  if (comma == std::string_view::npos || comma == 0 || comma + 1 == word.size()) return false;
  return is_digit(word[comma - 1]) && is_digit(word[comma + 1]) &&
         word.find(',', comma + 1) == std::string_view::npos && word.find('.') == std::string_view::npos;
}

/// Whether every comma between numbers is a decimal comma. Two integers "1,5" are taken for one, too: no
/// table with time stamps has rows of two integers.
bool has_decimal_commas(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return false;
  constexpr std::string_view kBetween = " \t\r;";
  constexpr std::string_view kOfNumbers = "0123456789+-.,eE";  // other words, as paths, tell nothing
  bool found = false;
  std::size_t begin = line.find_first_not_of(kBetween);
  while (begin != std::string_view::npos) {
    const std::size_t end = line.find_first_of(kBetween, begin);
    const std::string_view word = line.substr(begin, end - begin);
    begin = line.find_first_not_of(kBetween, end);
    if (word.find(',') == std::string_view::npos) continue;
    if (word.find_first_not_of(kOfNumbers) != std::string_view::npos) continue;
    if (!has_decimal_comma(word)) return false;
    found = true;
  }
  return found;
}

std::string quoted(std::string_view field) {
  constexpr std::size_t kMaxLength = 40;
  return "\"" + std::string(field.substr(0, kMaxLength)) + (field.size() > kMaxLength ? "...\"" : "\"");
}

}  // namespace

std::string_view TextRow::text(std::size_t field) const {
  if (field < fields.size() && !fields[field].empty()) return fields[field];
  if (field < fields.size())
    throw error("field " + std::to_string(field + 1) + " is empty; fill it, or remove the row");
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
  if (has_decimal_commas(content))
    throw error("has decimal commas; write numbers with a decimal point, e.g. with `tr , .`");
  const std::string_view found = text(field);
  const std::optional<Timestamp> t =
      unit == TimeUnit::kSeconds ? parse_stamp(found) : parse_nanoseconds(found);
  if (t) return *t;
  if (unit == TimeUnit::kNanoseconds) {
    throw error("stamp " + quoted(found) +
                " is not an integer number of nanoseconds; is the file in seconds?");
  }
  if (const double number = parse_number(found).value_or(0.0); number > 1.0) {
    // Milliseconds since 1970 are 1e11 to 5e12 from 1973 to 2128, microseconds a thousand times as many;
    // other numbers are nanoseconds, since 1970 or the start of the recording.
    const char* const likely_unit = number >= 1e11 && number < 5e12   ? "milli"
                                    : number >= 1e14 && number < 5e15 ? "micro"
                                                                      : "nano";
    throw error("stamp " + quoted(found) + " exceeds 292 years; is it in " + likely_unit +
                "seconds? convert it to seconds");
  }
  if (found.starts_with('"'))
    throw error("stamp " + std::string(found) +
                " is in quotation marks; remove them, e.g. with `tr -d '\"'`");
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
    if (!file_.empty()) {  // where the format is detected, the name is not known
      std::string problem = lines_.line_number() == 1 ? problem_of_start(*line) : "";
      if (problem.empty()) problem = problem_of_bytes(*line);
      if (!problem.empty()) throw InputError(std::string(file_), lines_.line_number(), problem);
    }
    const std::size_t begin = line->find_first_not_of(kSeparators);
    if (begin == std::string_view::npos || (*line)[begin] == '#') continue;
    if (!file_.empty() && has_inner_return(*line)) {
      throw InputError(std::string(file_), lines_.line_number(),
                       "lines end with carriage returns only; convert them, e.g. with `tr '\\r' '\\n'`");
    }
    fields_.clear();
    fields_ = split_fields(*line, std::move(fields_));
    return TextRow{.file = file_, .line = lines_.line_number(), .content = *line, .fields = fields_};
  }
  return std::nullopt;
}

}  // namespace stillpoint::eval
