// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/matrix_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <vector>

#include "eval/io/pose_row.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kSevenScenesRate = 30;  // [Hz]
constexpr double kRotationTolerance = 0.05;    // on |R^T R - I|; files have 6 digits or more

/// The pose of the first 12 numbers; nullopt if one is not finite.
std::optional<Pose> parse_matrix(std::span<const std::string_view> fields, const RowLocation& location) {
  Eigen::Matrix<double, 3, 4> matrix;
  for (std::size_t i = 0; i < 12; ++i) {
    const std::optional<double> value = parse_number(fields[i]);
    if (!value) throw location.error("\"" + std::string(fields[i]) + "\" is not a number");
    matrix(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = *value;
  }
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::Matrix3d R = matrix.leftCols<3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation < kRotationTolerance) || R.determinant() < 0.0) {
    throw location.error("the left 3x3 part is not a rotation; expected a row-major pose");
  }
  return Pose{Eigen::Quaterniond(R).normalized(), matrix.col(3)};
}

std::string matrix_rows(const Pose& pose, char row_end) {
  const Eigen::Matrix4d matrix = pose.matrix();
  std::string text;
  char row[160];
  for (Eigen::Index r = 0; r < 3; ++r) {
    std::snprintf(row, sizeof row, "%.12g %.12g %.12g %.12g%c", matrix(r, 0), matrix(r, 1), matrix(r, 2),
                  matrix(r, 3), r == 2 ? '\n' : row_end);
    text += row;
  }
  return text;
}

std::vector<Timestamp> parse_times(std::string_view text, const std::string& name) {
  std::vector<Timestamp> times;
  LineReader lines(text);
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> line = lines.next()) {
    split_fields(*line, fields);
    if (fields.empty() || fields.front().front() == '#') continue;
    times.push_back(require_stamp(fields.front(), {name, lines.line_number()}));
  }
  return times;
}

/// N of "frame-N.pose.txt".
std::optional<std::int64_t> frame_number(const std::string& name) {
  constexpr std::string_view kPrefix = "frame-";
  constexpr std::string_view kSuffix = ".pose.txt";
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return std::nullopt;
  const char* const begin = name.data() + kPrefix.size();
  const char* const end = name.data() + name.size() - kSuffix.size();
  std::int64_t number = 0;
  const auto [stop, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || stop != end || number < 0) return std::nullopt;
  return number;
}

}  // namespace

LoadedTrajectory parse_kitti(std::string_view poses, const std::string& poses_name, std::string_view times,
                             const std::string& times_name) {
  const std::vector<Timestamp> stamps = parse_times(times, times_name);
  LoadedTrajectory loaded;
  LineReader lines(poses);
  std::vector<std::string_view> fields;
  std::size_t row = 0;
  while (const std::optional<std::string_view> line = lines.next()) {
    split_fields(*line, fields);
    if (fields.empty() || fields.front().front() == '#') continue;
    const RowLocation location{poses_name, lines.line_number()};
    if (fields.size() != 12) {
      throw location.error("a KITTI pose has 12 numbers, found " + std::to_string(fields.size()));
    }
    if (row == stamps.size()) throw location.error("more poses than times in " + times_name);
    append_row(loaded, stamps[row++], parse_matrix(fields, location), location);
  }
  if (row < stamps.size()) throw InputError(times_name, "has more times than " + poses_name + " has poses");
  require_poses(loaded, poses_name);
  return loaded;
}

KittiTexts format_kitti(const Trajectory& trajectory) {
  KittiTexts texts;
  for (const auto& [t, pose] : trajectory.poses) {
    texts.poses += matrix_rows(pose, ' ');
    texts.times += format_stamp(t) + "\n";
  }
  return texts;
}

LoadedTrajectory read_seven_scenes(const fs::path& folder) {
  std::map<std::int64_t, fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (const auto number = frame_number(entry.path().filename().string())) files[*number] = entry.path();
  }
  if (error || files.empty()) {
    throw InputError(folder.string(), "no frame-N.pose.txt found; expected a 7-Scenes sequence folder");
  }
  LoadedTrajectory loaded;
  std::vector<std::string_view> fields;
  for (const auto& [number, file] : files) {
    const std::string text = read_text_file(file);
    std::string one_line = text;
    std::replace(one_line.begin(), one_line.end(), '\n', ' ');
    split_fields(one_line, fields);
    const std::string name = file.string();
    const RowLocation location{name, 1};
    if (fields.size() != 16) {
      throw location.error("a pose has 16 numbers, found " + std::to_string(fields.size()));
    }
    const std::int64_t ns = (number * kNsPerSecond + kSevenScenesRate / 2) / kSevenScenesRate;
    append_row(loaded, Timestamp{ns}, parse_matrix(fields, location), location);
  }
  require_poses(loaded, folder.string());
  return loaded;
}

void write_seven_scenes(const Trajectory& trajectory, const fs::path& folder) {
  std::int64_t last = -1;
  for (const auto& [t, pose] : trajectory.poses) {
    const std::int64_t number = std::llround(to_seconds(t) * static_cast<double>(kSevenScenesRate));
    if (number <= last) throw InputError(folder.string(), "two poses have the same frame number at 30 Hz");
    last = number;
    char name[64];
    std::snprintf(name, sizeof name, "frame-%06lld.pose.txt", static_cast<long long>(number));
    write_text_file(folder / name, matrix_rows(pose, '\n') + "0 0 0 1\n");
  }
}

}  // namespace stillpoint::eval
