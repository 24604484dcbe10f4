// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/matrix_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <vector>

#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kFrameRate = 30;      // [Hz]
constexpr double kEstimateTolerance = 0.05;  // of R R^T; estimates may be written with few digits

using MatrixNumbers = std::array<double, 16>;

bool all_finite(const MatrixNumbers& matrix) {
  return std::all_of(matrix.begin(), matrix.end(), [](double value) { return std::isfinite(value); });
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
  RowReader rows(text, name);
  while (const std::optional<TextRow> row = rows.next()) times.push_back(row->time(0, TimeUnit::kSeconds));
  return times;
}

/// The pose of a row of 12 numbers; nullopt if one of them is not finite.
std::optional<Pose> parse_kitti_pose(const TextRow& row) {
  if (row.fields.size() != 12) {
    throw row.error("a KITTI pose has 12 numbers, found " + std::to_string(row.fields.size()));
  }
  MatrixNumbers matrix{};
  for (std::size_t i = 0; i < 12; ++i) matrix[i] = row.number(i);
  matrix[15] = 1.0;
  if (!all_finite(matrix)) return std::nullopt;
  std::optional<Pose> pose = rigid_pose(matrix, kEstimateTolerance);
  if (!pose) throw row.error("the left 3x3 part is not a rotation; expected a row-major pose");
  return pose;
}

}  // namespace

std::optional<Pose> rigid_pose(std::span<const double, 16> row_major, double tolerance) {
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(row_major.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const Eigen::RowVector4d last(0.0, 0.0, 0.0, 1.0);
  const bool rigid = matrix.allFinite() && (R * R.transpose()).isIdentity(tolerance) &&
                     R.determinant() > 0.0 && (matrix.row(3) - last).norm() < tolerance;
  if (!rigid) return std::nullopt;
  return Pose::from_matrix(matrix);
}

std::optional<Pose> read_pose_matrix(const fs::path& file, PoseCheck check) {
  const bool estimate = check == PoseCheck::kEstimate;
  const std::string text = read_text_file(file);
  const std::string name = file.string();
  std::vector<double> numbers;
  RowReader rows(text, name);
  while (const std::optional<TextRow> row = rows.next()) {
    for (std::size_t i = 0; i < row->fields.size(); ++i) {
      numbers.push_back(estimate ? row->number(i) : row->finite_number(i));
    }
  }
  MatrixNumbers matrix{};
  if (numbers.size() != matrix.size()) {
    throw InputError(name, "contains " + std::to_string(numbers.size()) + " numbers, expected 16");
  }
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  if (!all_finite(matrix)) return std::nullopt;
  std::optional<Pose> pose = rigid_pose(matrix, estimate ? kEstimateTolerance : kRigidTolerance);
  if (!pose) throw InputError(name, "is not a rigid transform; remove the file if the pose is unknown");
  return pose;
}

LoadedTrajectory parse_kitti(std::string_view poses, const std::string& poses_name, std::string_view times,
                             const std::string& times_name) {
  const std::vector<Timestamp> stamps = parse_times(times, times_name);
  TrajectoryBuilder builder;
  RowReader rows(poses, poses_name);
  std::size_t next = 0;
  while (const std::optional<TextRow> row = rows.next()) {
    const std::optional<Pose> pose = parse_kitti_pose(*row);
    if (next == stamps.size()) throw row->error("more poses than times in " + times_name);
    builder.add(*row, stamps[next++], pose);
  }
  if (next < stamps.size()) throw InputError(times_name, "has more times than " + poses_name + " has poses");
  builder.require_poses(poses_name);
  builder.require_plausible_stamps(times_name);
  return builder.release();
}

KittiTexts format_kitti(const Trajectory& trajectory) {
  KittiTexts texts;
  for (const auto& [pose, t] : trajectory.poses) {
    texts.poses += matrix_rows(pose, ' ');
    texts.times += format_stamp(t) + "\n";
  }
  return texts;
}

std::optional<std::int64_t> seven_scenes_number(std::string_view file_name, std::string_view suffix) {
  constexpr std::string_view kPrefix = "frame-";
  if (!file_name.starts_with(kPrefix) || !file_name.ends_with(suffix)) return std::nullopt;
  if (file_name.size() < kPrefix.size() + suffix.size()) return std::nullopt;
  const char* const begin = file_name.data() + kPrefix.size();
  const char* const end = file_name.data() + file_name.size() - suffix.size();
  std::int64_t number = 0;
  const auto [stop, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || stop != end || number < 0) return std::nullopt;
  return number;
}

Timestamp time_of_frame(std::int64_t number) {
  STILLPOINT_CHECK(number <= kMaxFrameNumber);
  return Timestamp{(number * kNsPerSecond + kFrameRate / 2) / kFrameRate};
}

LoadedTrajectory read_seven_scenes(const fs::path& folder) {
  std::map<std::int64_t, fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (const auto number = seven_scenes_number(name, ".pose.txt")) files[*number] = entry.path();
  }
  if (error || files.empty()) {
    throw InputError(folder.string(),
                     "contains no trajectory: neither trajectory.tum, as the folder of a run, nor "
                     "frame-N.pose.txt, as a 7-Scenes sequence; name a file, such as groundtruth.txt");
  }
  if (const auto& [number, file] = *files.rbegin(); number > kMaxFrameNumber)
    throw InputError(file.string(),
                     "the number in the name is too large for that of a frame; if it is a "
                     "time, write the poses to one file in the TUM format");
  TrajectoryBuilder builder;
  for (const auto& [number, file] : files) {
    const std::string name = file.string();
    const TextRow whole_file{.file = name, .line = 1, .content = {}, .fields = {}};
    builder.add(whole_file, time_of_frame(number), read_pose_matrix(file, PoseCheck::kEstimate));
  }
  builder.require_poses(folder.string());
  return builder.release();
}

void write_seven_scenes(const Trajectory& trajectory, const fs::path& folder) {
  std::int64_t last = -1;
  for (const auto& [pose, t] : trajectory.poses) {
    const std::int64_t number = std::llround(to_seconds(t) * static_cast<double>(kFrameRate));
    if (number <= last) throw InputError(folder.string(), "two poses have the same frame number at 30 Hz");
    last = number;
    char name[64];
    std::snprintf(name, sizeof name, "frame-%06lld.pose.txt", static_cast<long long>(number));
    write_text_file(folder / name, matrix_rows(pose, '\n') + "0 0 0 1\n");
  }
}

}  // namespace stillpoint::eval
