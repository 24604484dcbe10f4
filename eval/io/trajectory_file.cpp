// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/trajectory_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <system_error>

#include "eval/io/column_header.h"
#include "eval/io/matrix_files.h"
#include "eval/io/nmea_file.h"
#include "eval/io/openloris_file.h"

namespace stillpoint::eval {
namespace {

namespace fs = std::filesystem;

constexpr double kNormTolerance = 0.1;          // rounding to 3 decimals changes the norm by 0.1 % only
constexpr double kGroundTruthTolerance = 0.01;  // rounding to 4 decimals stays far below
constexpr double kMaxCoordinate = 1e9;          // [m]; limits the loss of precision in sums of squares

std::string rows_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " row" : " rows"); }

}  // namespace

std::vector<std::string> repair_texts(const RowRepairs& repairs) {
  std::vector<std::string> texts;
  if (repairs.skipped > 0) {
    texts.push_back(rows_text(repairs.skipped) + " skipped: no valid pose (" +
                    std::string(repairs.skip_reason) + ")");
  }
  if (repairs.repeated > 0) {
    texts.push_back(rows_text(repairs.repeated) +
                    " skipped: the time stamp repeats that of an earlier row, which is used");
  }
  if (repairs.reordered > 0) {
    texts.push_back(rows_text(repairs.reordered) + " sorted by time: earlier than a row before");
  }
  if (repairs.unstamped > 0) {
    texts.push_back(rows_text(repairs.unstamped) + " with the stamp 0: the time of recording is used");
  }
  return texts;
}

PoseColumns consecutive_columns(std::size_t first, QuaternionOrder order) {
  PoseColumns columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = first + i;
  if (order == QuaternionOrder::kWxyz) std::rotate(columns.begin() + 3, columns.begin() + 4, columns.end());
  return columns;
}

Trajectory with_other_order(const Trajectory& trajectory, QuaternionOrder read) {
  Trajectory reordered = trajectory;
  for (StampedPose& pose : reordered.poses) {
    const Eigen::Quaterniond q = pose.T_w_f.q;
    pose.T_w_f.q = read == QuaternionOrder::kXyzw ? Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w())
                                                  : Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
  }
  return reordered;
}

std::optional<Pose> parse_pose(const TextRow& row, const PoseColumns& columns, PoseCheck check) {
  const bool may_skip = check == PoseCheck::kEstimate;
  std::array<double, 7> v{};
  bool finite = true;
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] = may_skip ? row.number(columns[i]) : row.finite_number(columns[i]);
    finite = finite && std::isfinite(v[i]);
  }
  if (!finite) return std::nullopt;
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  const double norm = q.norm();
  if (may_skip && norm == 0.0) return std::nullopt;
  if (std::abs(norm - 1.0) > (may_skip ? kNormTolerance : kGroundTruthTolerance)) {
    throw row.error("the quaternion has norm " + std::to_string(norm) +
                    ", expected 1; check the order of the columns");
  }
  const Eigen::Vector3d p(v[0], v[1], v[2]);
  if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    throw row.error("position exceeds 1e9 m; is the file in meters?");
  }
  return Pose{Eigen::Quaterniond(q.coeffs() / norm), p};
}

void TrajectoryBuilder::add(const TextRow& row, Timestamp t, const std::optional<Pose>& pose) {
  std::vector<StampedPose>& poses = loaded_.trajectory.poses;
  if (!pose) {
    ++loaded_.repairs.skipped;
  } else if (poses.empty() || t > poses.back().t) {
    poses.push_back({t, *pose});
  } else {
    sort_in(row, {t, *pose});
  }
}

void TrajectoryBuilder::sort_in(const TextRow& row, const StampedPose& pose) {
  std::vector<StampedPose>& poses = loaded_.trajectory.poses;
  const double delay_s = seconds_between(pose.t, poses.back().t);
  if (delay_s > kMaxDisorder_s) {
    throw row.error("stamp " + format_stamp(pose.t) + " s is " + std::to_string(delay_s) +
                    " s earlier than a row before; sort the file by time, or split it if it contains several "
                    "runs");
  }
  const auto next = std::lower_bound(poses.begin(), poses.end(), pose.t,
                                     [](const StampedPose& known, Timestamp t) { return known.t < t; });
  if (next->t == pose.t) {
    ++loaded_.repairs.repeated;
  } else {
    ++loaded_.repairs.reordered;
    poses.insert(next, pose);
  }
}

void TrajectoryBuilder::require_poses(const std::string& file) const {
  if (!loaded_.trajectory.poses.empty()) return;
  throw InputError(file, loaded_.repairs.skipped > 0
                             ? "no valid pose: all rows have NaN or a zero quaternion"
                             : "no poses found; expected rows \"t tx ty tz qx qy qz qw\"");
}

void TrajectoryBuilder::require_plausible_stamps(const std::string& file) const {
  const std::size_t kept = loaded_.trajectory.poses.size();
  const std::size_t repeated = loaded_.repairs.repeated;
  constexpr std::size_t kMostRowsPerStamp = 5;
  if (kept > 0 && kept + repeated > kMostRowsPerStamp * kept) {
    throw InputError(file, rows_text(kept + repeated) + " have " + std::to_string(kept) +
                               (kept == 1 ? " stamp (" : " different stamps (the first: ") +
                               format_stamp(loaded_.trajectory.poses.front().t) +
                               " s); if they lost digits, as in 1.30503e+09, write them with 9 decimals");
  }
  constexpr double kMaxInterval = 3600.0;   // [s]
  constexpr double kMinNanoseconds = 5e6;   // 5 s of microseconds: no system is as slow
  constexpr double kMaxMicroseconds = 5e5;  // 0.5 ms of nanoseconds: no system is as fast
  const std::vector<StampedPose>& poses = loaded_.trajectory.poses;
  if (poses.size() < 3) return;
  const auto count = static_cast<double>(poses.size() - 1);
  if (seconds_between(poses.front().t, poses.back().t) < 0.5 * kMaxInterval * count) return;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i)
    intervals.push_back(seconds_between(poses[i - 1].t, poses[i].t));
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>((intervals.size() - 1) / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  if (*middle <= kMaxInterval) return;
  const char* const unit = *middle > kMinNanoseconds    ? "nanoseconds"
                           : *middle < kMaxMicroseconds ? "microseconds"
                                                        : "microseconds or nanoseconds";
  char text[200];
  std::snprintf(text, sizeof text,
                "as seconds, the stamps are %.3g s apart: they seem to be in %s; convert them to seconds, or "
                "name nanoseconds in the header (\"timestamp [ns]\")",
                *middle, unit);
  throw InputError(file, text);
}

namespace {

constexpr std::size_t kMinNanosecondDigits = 16;  // 10^15 ns are 11 days; 10^15 s would be 30 million years

/// Whether a stamp is too large for seconds.
bool is_nanoseconds(std::string_view stamp) {
  const std::size_t digits = std::min(stamp.find_first_not_of("0123456789"), stamp.size());
  return digits >= kMinNanosecondDigits && parse_nanoseconds(stamp);
}

/// A format with one pose per row: the stamp, then the pose.
struct RowFormat {
  TimeUnit unit;
  QuaternionOrder order;
  const char* columns;  ///< for messages
};
constexpr RowFormat kTum{TimeUnit::kSeconds, QuaternionOrder::kXyzw, "t tx ty tz qx qy qz qw"};
constexpr RowFormat kEuroc{TimeUnit::kNanoseconds, QuaternionOrder::kWxyz, "ns,px,py,pz,qw,qx,qy,qz"};
constexpr RowFormat kOrbSlam3{TimeUnit::kNanoseconds, QuaternionOrder::kXyzw, "ns tx ty tz qx qy qz qw"};

/// Whether the first row has commas or semicolons between its fields.
bool is_delimited(std::string_view text, const std::string& name) {
  RowReader rows(text, name);
  const std::optional<TextRow> first = rows.next();
  return first && first->content.find_first_of(",;") != std::string_view::npos;
}

/// Of rows with stamps in nanoseconds: without names of the columns, the separator tells which program wrote
/// them.
const RowFormat& nanosecond_format(std::string_view text, const std::string& name) {
  return is_delimited(text, name) ? kEuroc : kOrbSlam3;
}

/// A text, or the first records of one, and the name of its file.
struct NamedText {
  std::string_view text;
  const std::string& name;
  std::size_t estimated_rows = 0;  ///< of the file
};

/// Where the values of a row are.
struct RowLayout {
  TimeColumns time;
  PoseColumns pose{};
  TimeUnit unit = TimeUnit::kSeconds;
  long header_line = 0;  ///< of a header that is no comment; 0 without one
  bool is_named = false;
};

/// The unit of the stamps of a file with a header.
TimeUnit named_unit(const NamedText& source, const TableHeader& header, TimeUnit of_format) {
  if (const std::optional<TimeUnit> stated = time_unit(header, source.name)) return *stated;
  RowReader rows(source.text, source.name);
  while (const std::optional<TextRow> row = rows.next()) {
    if (row->line > header.line)
      return is_nanoseconds(row->text(time_columns(header)->stamp)) ? TimeUnit::kNanoseconds : of_format;
  }
  return of_format;
}

/// Whether a unit of a header is a length other than m.
bool is_other_length(std::string_view unit) {
  return unit == "mm" || unit == "cm" || unit == "dm" || unit == "km" || unit == "in" || unit == "ft" ||
         unit.starts_with("milli") || unit.starts_with("centi") || unit.starts_with("kilo");
}

/// By the header, else by the format.
/// @throws InputError if a header that is no comment does not name the columns of a pose, or a header states
/// another unit of positions than m, or Euler angles
RowLayout layout_of(const NamedText& source, const RowFormat& format) {
  const TableHeader header = find_header(source.text);
  const std::optional<TimeColumns> time = time_columns(header);
  const std::vector<std::size_t> p = columns_of(header, Quantity::kPosition);
  const std::vector<std::size_t> q = columns_of(header, Quantity::kQuaternion);
  RowLayout layout{.pose = consecutive_columns(1, format.order), .unit = format.unit};
  if (const std::string unit = unit_of(header, Quantity::kPosition); is_other_length(unit))
    throw InputError(source.name, header.line, "the positions are in " + unit + "; convert them to m");
  if (q.empty() && names_euler_angles(header))
    throw InputError(source.name, header.line,
                     "the orientations are roll, pitch and yaw; convert them to quaternions qx qy qz qw");
  if (time && !p.empty() && !q.empty() && fits_rows(header, source.text)) {
    layout = {.time = *time, .unit = named_unit(source, header, format.unit), .is_named = true};
    std::copy(q.begin(), q.end(), std::copy(p.begin(), p.end(), layout.pose.begin()));
  } else if (!header.columns.empty() && !header.is_comment) {
    throw InputError(source.name, header.line,
                     std::string("the header does not name the columns of a stamp and a pose once each; "
                                 "expected names such as \"") +
                         kTum.columns + "\", or no header");
  }
  if (!header.is_comment) layout.header_line = header.line;
  return layout;
}

/// How the rows of a file are read.
struct RowRules {
  const RowFormat& format;
  PoseCheck check = PoseCheck::kEstimate;
};

/// Whether the numbers of a row from `first` on are the three rows of a rigid transformation.
bool is_matrix(const TextRow& row, std::size_t first, double tolerance) {
  Eigen::Matrix3d R;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j)
      R(i, j) = parse_number(row.fields[first + static_cast<std::size_t>(4 * i + j)]).value_or(2.0);
  }
  return (R * R.transpose()).isIdentity(tolerance);
}

/// Rows of a matrix, with or without the stamp and the last row 0 0 0 1, may look like a pose: [1 0 0 | x]
/// would be read as a position, and the quaternion after it has norm 1 for a small x.
/// @throws InputError if the numbers of a row without names are those of a rigid transformation
void require_no_matrix(const TextRow& row) {
  constexpr double kTolerance = 1e-3;
  const std::size_t count = row.fields.size();
  if (count != 13 && count != 16 && count != 17) return;
  if (!is_matrix(row, count == 16 ? 0 : 1, kTolerance)) return;
  throw row.error(
      "has " + std::to_string(count) +
      " numbers, which are a matrix; write rows \"t tx ty tz qx qy qz qw\", or the first three rows "
      "of each matrix as 12 numbers (KITTI) and the stamps in another file (--times)");
}

/// Whether a row of 12 numbers is a stamp, a pose and four further columns, not a matrix.
bool is_pose_of_twelve(const TextRow& row) {
  constexpr double kMatrixTolerance = 0.3;  // a matrix that is rounded or scaled is an error of its own
  Eigen::Vector4d q;
  for (Eigen::Index i = 0; i < 4; ++i)
    q(i) = parse_number(row.fields[static_cast<std::size_t>(4 + i)]).value_or(0.0);
  return std::abs(q.norm() - 1.0) <= kNormTolerance && !is_matrix(row, 0, kMatrixTolerance);
}

/// @param start the first records, by which the layout is found
/// @param all the records of the whole file
LoadedTrajectory parse_rows(const NamedText& start, RowReader all, const RowRules& rules, FaultLog& faults) {
  const RowLayout layout = layout_of(start, rules.format);
  TrajectoryBuilder builder(start.estimated_rows);
  for_each_row(std::move(all), faults, [&](const TextRow& row) {
    if (row.line == layout.header_line) return;
    if (row.fields.size() < 8 && !layout.is_named) {
      throw row.error("a pose needs 8 numbers, found " + std::to_string(row.fields.size()) + "; expected \"" +
                      rules.format.columns + "\"");
    }
    if (!layout.is_named && builder.is_empty()) require_no_matrix(row);
    const Timestamp t = stamp_of(row, layout.time, layout.unit);
    builder.add(row, t, parse_pose(row, layout.pose, rules.check));
  });
  faults.guard([&] {
    builder.require_poses(start.name);
    builder.require_plausible_stamps(start.name);
  });
  LoadedTrajectory loaded = builder.release();
  loaded.order = layout.is_named ? QuaternionOrder::kXyzw : rules.format.order;
  loaded.order_source = layout.is_named ? OrderSource::kNamed : OrderSource::kFormat;
  return loaded;
}

LoadedTrajectory parse_text(const NamedText& source, const RowRules& rules, FaultLog& faults) {
  return parse_rows(source, RowReader(source.text, source.name), rules, faults);
}

LoadedTrajectory parse_file(TextBlocks& file, const std::string& name, const RowRules& rules,
                            FaultLog& faults) {
  return parse_rows({file.block(), name, file.estimated_lines()}, RowReader(file, name), rules, faults);
}

/// A ground-truth file.
struct TruthFile {
  const std::filesystem::path& path;
  const RowFormat& format;
  const std::string& frame;
};

LoadedTrajectory read_ground_truth(const TruthFile& file, FaultLog& faults) {
  TextBlocks blocks(file.path);
  LoadedTrajectory loaded =
      parse_file(blocks, file.path.string(), {file.format, PoseCheck::kGroundTruth}, faults);
  loaded.trajectory.frame = file.frame;
  return loaded;
}

}  // namespace

LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame) {
  TextBlocks blocks(file);
  FaultLog strict;
  LoadedTrajectory loaded = parse_file(blocks, file.string(), {kTum}, strict);
  loaded.trajectory.frame = frame;
  return loaded;
}

LoadedTrajectory parse_tum(std::string_view text, const std::string& name, const std::string& frame) {
  FaultLog strict;
  LoadedTrajectory loaded = parse_text({text, name}, {kTum}, strict);
  loaded.trajectory.frame = frame;
  return loaded;
}

LoadedTrajectory parse_euroc(std::string_view text, const std::string& name) {
  FaultLog strict;
  return parse_text({text, name}, {nanosecond_format(text, name)}, strict);
}

LoadedTrajectory read_tum_ground_truth(const std::filesystem::path& file, const std::string& frame,
                                       FaultLog& faults) {
  return read_ground_truth({file, kTum, frame}, faults);
}

LoadedTrajectory read_euroc_ground_truth(const std::filesystem::path& file, const std::string& frame,
                                         FaultLog& faults) {
  return read_ground_truth({file, kEuroc, frame}, faults);
}

void write_tum(const Trajectory& trajectory, const std::filesystem::path& file) {
  write_text_file(file, format_tum(trajectory));
}

std::string format_tum(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  text.reserve(text.size() + 110 * trajectory.poses.size());
  char row[320];
  for (const auto& [pose, t] : trajectory.poses) {
    const int length = std::snprintf(row, sizeof row, " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.p.x(),
                                     pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
    STILLPOINT_CHECK(length > 0 && length < static_cast<int>(sizeof row));
    text += format_stamp(t);
    text.append(row, static_cast<std::size_t>(length));
  }
  return text;
}

std::string format_euroc(const Trajectory& trajectory) {
  std::string text =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
  char row[360];
  for (const auto& [pose, t] : trajectory.poses) {
    std::snprintf(row, sizeof row, "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", static_cast<long long>(t.ns),
                  pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
    text += row;
  }
  return text;
}

namespace {

bool has_bag_extension(const fs::path& path) {
  const fs::path extension = path.extension();
  return extension == ".bag" || extension == ".mcap" || extension == ".db3";
}

/// The name of a recording, and the number of a part: "NAME_" and 2 of "NAME_2024-05-01-10-00-00_2.bag".
std::optional<std::pair<std::string, std::size_t>> part_of_split(const fs::path& file) {
  constexpr std::string_view kDate = "0000-00-00-00-00-00";
  const std::string stem = file.stem().string();
  const std::size_t end = stem.rfind('_');
  std::size_t number = 0;
  if (file.extension() != ".bag" || end == std::string::npos) return std::nullopt;
  const auto [last, error] = std::from_chars(stem.data() + end + 1, stem.data() + stem.size(), number);
  if (error != std::errc{} || last != stem.data() + stem.size()) return std::nullopt;
  std::string name = stem.substr(0, end);
  const auto fits = [](char letter, char form) {
    return form == '-' ? letter == '-' : letter >= '0' && letter <= '9';
  };
  if (name.size() >= kDate.size() && std::equal(kDate.rbegin(), kDate.rend(), name.rbegin(),
                                                [&](char form, char letter) { return fits(letter, form); }))
    name.resize(name.size() - kDate.size());
  return std::pair(name, number);
}

}  // namespace

std::vector<fs::path> split_bag_parts(const fs::path& folder) {
  std::map<std::size_t, fs::path> parts;  // by number
  std::set<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_directory()) return {};
    if (!has_bag_extension(entry->path())) continue;
    const auto part = part_of_split(entry->path());
    if (!part || !parts.try_emplace(part->second, entry->path()).second) return {};
    names.insert(part->first);
  }
  if (error || names.size() != 1 || parts.size() < 2 || parts.rbegin()->first + 1 != parts.size()) return {};
  std::vector<fs::path> files;
  for (const auto& [number, file] : parts) files.push_back(file);
  return files;
}

bool is_bag(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return has_bag_extension(path);
  if (!fs::exists(path / "metadata.yaml", ignored)) return !split_bag_parts(path).empty();
  return std::any_of(fs::directory_iterator(path, ignored), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) {
                       return has_bag_extension(entry.path()) || has_bag_extension(entry.path().stem());
                     });
}

namespace {

LoadedTrajectory one_sequence(OpenlorisFile file, const TrajectorySource& source) {
  auto selected = file.sequences.begin();
  if (source.sequence != 0) {
    selected = file.sequences.find(source.sequence);
    if (selected == file.sequences.end()) {
      throw InputError(source.path.string(), "has no sequence " + std::to_string(source.sequence));
    }
  } else if (file.sequences.size() > 1) {
    throw InputError(source.path.string(), "contains " + std::to_string(file.sequences.size()) +
                                               " sequences; select one with --seq");
  }
  return {std::move(selected->second), file.repairs};
}

}  // namespace

namespace {

/// "key: value", in contrast to a row that begins with a date or a time of day.
bool is_key_line(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return line.find(':') != std::string_view::npos && line.find_first_of("0123456789") != first;
}

}  // namespace

TrajectoryFormat detect_format(std::string_view text, const std::string& name) {
  if (is_nmea(text)) return TrajectoryFormat::kNmea;
  const TableHeader header = find_header(text);
  const std::size_t time = time_columns(header).value_or(TimeColumns{}).stamp;
  const bool has_names = !columns_of(header, Quantity::kPosition).empty();
  if (has_names && time_unit(header, name) == TimeUnit::kNanoseconds) return TrajectoryFormat::kEuroc;
  RowReader rows(text, "");
  while (const std::optional<TextRow> row = rows.next()) {
    if (!header.is_comment && row->line == header.line) continue;
    if (is_key_line(row->content)) return TrajectoryFormat::kOpenloris;
    if (row->fields.size() > time && is_nanoseconds(row->fields[time])) return TrajectoryFormat::kEuroc;
    if (row->fields.size() == 12 && !has_names && !is_pose_of_twelve(*row)) return TrajectoryFormat::kKitti;
    return TrajectoryFormat::kTum;
  }
  return TrajectoryFormat::kTum;
}

namespace {

/// @throws InputError if poses are closer in time than systems report them: stamps in microseconds since 1970
/// have 16 digits, too
void require_plausible_nanoseconds(const LoadedTrajectory& loaded, const std::string& name, bool is_stated) {
  constexpr double kMinInterval = 5e-4;  // [s]
  // Of stamps with 16 digits without a unit: keyframes in microseconds that are up to 10 s apart. Those of a
  // clock that runs since 12 to 115 days, at more than 100 Hz, have to state the unit.
  constexpr double kMinUnstatedInterval = 1e-2;  // [s]
  constexpr std::int64_t kMax16Digits = 9'999'999'999'999'999;
  const std::vector<StampedPose>& poses = loaded.trajectory.poses;
  if (poses.size() < 2) return;
  const double interval_s =
      seconds_between(poses.front().t, poses.back().t) / static_cast<double>(poses.size() - 1);
  const bool is_ambiguous = !is_stated && poses.back().t.ns <= kMax16Digits;
  if (interval_s >= (is_ambiguous ? kMinUnstatedInterval : kMinInterval)) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "as nanoseconds, the stamps are %.3g ms apart: they seem to be in microseconds; convert them to "
      "seconds or nanoseconds%s",
      1e3 * interval_s, is_ambiguous ? ", or name nanoseconds in a header (\"timestamp [ns]\")" : "");
  throw InputError(name, text);
}

/// Rows with stamps in nanoseconds that were recognized by these.
LoadedTrajectory parse_detected_nanoseconds(TextBlocks& file, const std::string& name) {
  FaultLog strict;
  const bool is_stated = time_unit(find_header(file.block()), name).has_value();
  LoadedTrajectory loaded = parse_file(file, name, {nanosecond_format(file.block(), name)}, strict);
  require_plausible_nanoseconds(loaded, name, is_stated);
  if (loaded.order_source == OrderSource::kFormat) loaded.order_source = OrderSource::kAssumed;
  return loaded;
}

/// Rows with stamps in seconds. The order of quaternions is that of the TUM format, which has blanks between
/// the fields: systems that write commas have either order.
LoadedTrajectory parse_detected_seconds(TextBlocks& file, const std::string& name) {
  FaultLog strict;
  const bool has_delimiters = is_delimited(file.block(), name);
  LoadedTrajectory loaded = parse_file(file, name, {kTum}, strict);
  if (has_delimiters && loaded.order_source == OrderSource::kFormat)
    loaded.order_source = OrderSource::kAssumed;
  return loaded;
}

}  // namespace

namespace {

/// @param format of the file, a format of rows or sentences
LoadedTrajectory read_text(const TrajectorySource& source, TextBlocks& file, TrajectoryFormat format) {
  const std::string name = source.path.string();
  FaultLog strict;
  switch (format) {
    case TrajectoryFormat::kTum:
      return source.format ? parse_file(file, name, {kTum}, strict) : parse_detected_seconds(file, name);
    case TrajectoryFormat::kEuroc:
      return source.format ? parse_file(file, name, {kEuroc}, strict)
                           : parse_detected_nanoseconds(file, name);
    case TrajectoryFormat::kKitti:
      if (source.times.empty()) {
        throw InputError(name, "KITTI poses have no time stamps; specify their file with --times");
      }
      return parse_kitti(read_text_file(source.path), name, read_text_file(source.times),
                         source.times.string());
    case TrajectoryFormat::kOpenloris:
      return one_sequence(parse_openloris(read_text_file(source.path), name), source);
    default:
      return parse_nmea(read_text_file(source.path), name);
  }
}

}  // namespace

LoadedTrajectory read_trajectory(const TrajectorySource& source) {
  if (is_bag(source.path))
    throw InputError(source.path.string(), "is a bag; name the topic of the poses, e.g. " +
                                               source.path.string() + ":/ground_truth");
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(source.path, ignored);
  if (source.format == TrajectoryFormat::kSevenScenes || (!source.format && is_folder)) {
    return read_seven_scenes(source.path);
  }
  TextBlocks file(source.path);
  const TrajectoryFormat format =
      source.format ? *source.format : detect_format(file.block(), source.path.string());
  LoadedTrajectory loaded = read_text(source, file, format);
  loaded.format = format;
  return loaded;
}

}  // namespace stillpoint::eval
