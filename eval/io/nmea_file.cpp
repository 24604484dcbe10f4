// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/nmea_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace stillpoint::eval {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kSecondsPerDay = 86400.0;

std::vector<std::string_view> split(std::string_view sentence) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = sentence.find(',');
    fields.push_back(sentence.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    sentence.remove_prefix(comma + 1);
  }
}

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

/// "4807.038" and "N" -> 48.1173. @param degree_digits 2 or 3
std::optional<double> angle_deg(std::string_view text, std::string_view side, std::size_t degree_digits) {
  if (text.size() < degree_digits + 2 || side.size() != 1) return std::nullopt;
  const auto degrees = number(text.substr(0, degree_digits));
  const auto minutes = number(text.substr(degree_digits));
  if (!degrees || !minutes || *minutes < 0.0 || *minutes >= 60.0) return std::nullopt;
  const double sign = side == "S" || side == "W" ? -1.0 : 1.0;
  return sign * (*degrees + *minutes / 60.0);
}

/// "123519.50" -> seconds of the day.
std::optional<double> time_of_day_s(std::string_view text) {
  if (text.size() < 6) return std::nullopt;
  const auto hours = number(text.substr(0, 2));
  const auto minutes = number(text.substr(2, 2));
  const auto seconds = number(text.substr(4));
  if (!hours || !minutes || !seconds) return std::nullopt;
  return *hours * 3600.0 + *minutes * 60.0 + *seconds;
}

/// "230394" -> days since 1970. Years 80 to 99 are those of the last century.
std::optional<int> date_days(std::string_view text) {
  if (text.size() != 6) return std::nullopt;
  const auto day = number(text.substr(0, 2));
  const auto month = number(text.substr(2, 2));
  const auto year = number(text.substr(4, 2));
  if (!day || !month || !year) return std::nullopt;
  const int century = *year >= 80.0 ? 1900 : 2000;
  const std::chrono::year_month_day date{std::chrono::year(century + static_cast<int>(*year)),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  return static_cast<int>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// The sentence between "$" and "*"; empty if the checksum is wrong. A checksum is optional.
std::string_view checked_sentence(std::string_view line) {
  if (!line.starts_with('$')) return {};
  line.remove_prefix(1);
  const std::size_t star = line.find('*');
  const std::string_view sentence = line.substr(0, star);
  if (star == std::string_view::npos) return sentence;
  unsigned sum = 0;
  for (const char letter : sentence) sum ^= static_cast<unsigned char>(letter);
  unsigned expected = 0;
  const std::string_view digits = line.substr(star + 1, 2);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), expected, 16);
  return error == std::errc{} && expected == sum ? sentence : std::string_view{};
}

struct Fix {
  double time_of_day_s = 0.0;
  GeodeticPosition position;
  int day = 0;  ///< of a `DayCounter`
};

/// A GGA sentence; empty without a fix.
std::optional<Fix> parse_gga(const std::vector<std::string_view>& fields) {
  if (fields.size() < 12 || fields[6] == "0" || fields[6].empty()) return std::nullopt;
  const auto time = time_of_day_s(fields[1]);
  const auto latitude = angle_deg(fields[2], fields[3], 2);
  const auto longitude = angle_deg(fields[4], fields[5], 3);
  const auto altitude = number(fields[9]);
  if (!time || !latitude || !longitude || !altitude) return std::nullopt;
  return Fix{*time, {*latitude, *longitude, *altitude + number(fields[11]).value_or(0.0)}};
}

/// Counts the days of sentences, which state the time of day only.
class DayCounter {
 public:
  /// The day of the next sentence, from 0 on. A time that is up to half a day earlier is out of order, one
  /// that is even earlier is of the next day.
  int advance_to(double time_of_day_s) {
    const double back_s = previous_s_.value_or(time_of_day_s) - time_of_day_s;
    day_ += static_cast<int>(std::lround(back_s / kSecondsPerDay));
    previous_s_ = time_of_day_s;
    return day_;
  }

 private:
  int day_ = 0;
  std::optional<double> previous_s_;
};

struct DatedTime {
  int days = 0;  ///< since 1970
  double time_of_day_s = 0.0;
};

/// A RMC sentence; nullopt if it is not valid.
std::optional<DatedTime> parse_rmc(const std::vector<std::string_view>& fields) {
  if (fields.size() <= 9 || fields[2] != "A") return std::nullopt;  // V: the date may be that of the firmware
  const std::optional<int> days = date_days(fields[9]);
  const std::optional<double> time = time_of_day_s(fields[1]);
  if (!days || !time) return std::nullopt;
  return DatedTime{*days, *time};
}

/// Fixes of a text, and the date of day 0.
struct NmeaContent {
  std::vector<Fix> fixes;
  std::optional<int> first_day;  ///< by the first valid RMC, which may be after midnight
  std::size_t skipped = 0;
};

NmeaContent parse_sentences(std::string_view text) {
  NmeaContent content;
  DayCounter days;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = split(checked_sentence(line));
    const bool is_known = fields.front().size() == 5;
    if (is_known && fields.front().ends_with("RMC")) {
      const std::optional<DatedTime> date = content.first_day ? std::nullopt : parse_rmc(fields);
      if (date) content.first_day = date->days - days.advance_to(date->time_of_day_s);
    } else if (is_known && fields.front().ends_with("GGA")) {
      std::optional<Fix> fix = parse_gga(fields);
      if (fix) fix->day = days.advance_to(fix->time_of_day_s);
      if (fix) content.fixes.push_back(*fix);
      content.skipped += fix ? 0 : 1;
    } else if (!is_known) {
      ++content.skipped;
    }
  }
  return content;
}

}  // namespace

Eigen::Vector3d ecef(const GeodeticPosition& position) {
  constexpr double kSemiMajorM = 6378137.0;
  constexpr double kFlattening = 1.0 / 298.257223563;
  constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);
  const double latitude = position.latitude_deg * kRadPerDeg;
  const double longitude = position.longitude_deg * kRadPerDeg;
  const double sine = std::sin(latitude);
  const double normal_m = kSemiMajorM / std::sqrt(1.0 - kEccentricity2 * sine * sine);
  return {(normal_m + position.height_m) * std::cos(latitude) * std::cos(longitude),
          (normal_m + position.height_m) * std::cos(latitude) * std::sin(longitude),
          (normal_m * (1.0 - kEccentricity2) + position.height_m) * sine};
}

Eigen::Vector3d east_north_up(const GeodeticPosition& position, const GeodeticPosition& origin) {
  const double latitude = origin.latitude_deg * kRadPerDeg;
  const double longitude = origin.longitude_deg * kRadPerDeg;
  const Eigen::Vector3d east(-std::sin(longitude), std::cos(longitude), 0.0);
  const Eigen::Vector3d up(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                           std::sin(latitude));
  const Eigen::Vector3d difference = ecef(position) - ecef(origin);
  return {east.dot(difference), up.cross(east).dot(difference), up.dot(difference)};
}

bool is_nmea(std::string_view text) {
  constexpr std::size_t kMaxLines = 20;  // a log may start within a sentence, or with lines of the logger
  LineReader lines(text);
  for (std::size_t i = 0; i < kMaxLines; ++i) {
    const std::optional<std::string_view> line = lines.next();
    if (!line) return false;
    const bool is_sentence = line->size() >= 7 && line->front() == '$' && (*line)[6] == ',' &&
                             std::all_of(line->begin() + 1, line->begin() + 6, [](unsigned char c) {
                               return std::isupper(c) != 0 || std::isdigit(c) != 0;
                             });
    if (is_sentence) return true;
  }
  return false;
}

LoadedTrajectory parse_nmea(std::string_view text, const std::string& name) {
  const NmeaContent content = parse_sentences(text);
  if (content.fixes.empty())
    throw InputError(
        name,
        "has no GGA sentence with a position; record with a GNSS fix, or, if the file is no NMEA, name "
        "the format of the other one only: --format gt=nmea");
  if (!content.first_day)
    throw InputError(name,
                     "has no valid RMC sentence (status A) with a date; record RMC as well as GGA sentences");
  LoadedTrajectory loaded;
  loaded.trajectory.frame = kGnssFrame;
  loaded.repairs.skipped = content.skipped;
  loaded.repairs.skip_reason = "no GNSS fix or a damaged sentence";
  for (const Fix& fix : content.fixes) {
    StampedPose pose;
    pose.t = from_seconds(kSecondsPerDay * (*content.first_day + fix.day) + fix.time_of_day_s);
    pose.T_w_f.p = east_north_up(fix.position, content.fixes.front().position);
    const bool is_later = loaded.trajectory.poses.empty() || loaded.trajectory.poses.back().t < pose.t;
    if (is_later) loaded.trajectory.poses.push_back(pose);
    loaded.repairs.repeated += is_later ? 0 : 1;
  }
  return loaded;
}

}  // namespace stillpoint::eval
