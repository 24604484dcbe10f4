// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/trajectory_file.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "datasets/io/text_table.h"

namespace stillpoint::datasets {
namespace {

constexpr double kUnitTolerance = 0.01;      ///< rounding of 4-decimal quaternions stays far below
constexpr double kRotationTolerance = 1e-3;  ///< rounding of 4-decimal matrices stays below

/// Field indices of the columns.
struct Columns {
  std::size_t position = 1;
  std::size_t qx = 4;
  std::size_t qw = 7;
};

Pose pose_at(const TextTable& table, const TextRow& row, const Columns& columns) {
  const Eigen::Vector3d p(table.number(row, columns.position), table.number(row, columns.position + 1),
                          table.number(row, columns.position + 2));
  const Eigen::Quaterniond q(table.number(row, columns.qw), table.number(row, columns.qx),
                             table.number(row, columns.qx + 1), table.number(row, columns.qx + 2));
  if (std::abs(q.norm() - 1.0) > kUnitTolerance) {
    table.fail(
        row, "the quaternion has norm " + std::to_string(q.norm()) + ", expected 1; check the column order");
  }
  return Pose{q.normalized(), p};
}

template <class ParseTime>
Trajectory read_poses(const std::filesystem::path& file, const Columns& columns, FaultLog& faults,
                      const ParseTime& parse_time) {
  const TextTable table(file);
  std::vector<StampedPose> poses;
  poses.reserve(table.rows().size());
  table.for_each(faults, [&](const TextRow& row) {
    const StampedPose pose{.t = parse_time(table, row), .T_w_f = pose_at(table, row, columns)};
    if (!poses.empty()) table.require_increasing(row, poses.back().t, pose.t);
    poses.push_back(pose);
  });
  return Trajectory{.frame = {}, .poses = std::move(poses)};
}

}  // namespace

Trajectory read_tum_trajectory(const std::filesystem::path& file, const std::string& frame,
                               FaultLog& faults) {
  Trajectory trajectory = read_poses(file, Columns{}, faults, [](const TextTable& table, const TextRow& row) {
    return table.seconds(row, 0);
  });
  trajectory.frame = frame;
  return trajectory;
}

Trajectory read_euroc_trajectory(const std::filesystem::path& file, const std::string& frame,
                                 FaultLog& faults) {
  Trajectory trajectory =
      read_poses(file, Columns{.position = 1, .qx = 5, .qw = 4}, faults,
                 [](const TextTable& table, const TextRow& row) { return table.nanoseconds(row, 0); });
  trajectory.frame = frame;
  return trajectory;
}

Pose read_pose_matrix(const std::filesystem::path& file) {
  const TextTable table(file);
  std::vector<double> numbers;
  for (const TextRow& row : table.rows()) {
    for (std::size_t i = 0; i < row.fields.size(); ++i) numbers.push_back(table.number(row, i));
  }
  if (numbers.size() != 16) {
    table.fail("contains " + std::to_string(numbers.size()) + " numbers, expected 16");
  }
  const std::optional<Pose> pose = rigid_pose(std::span<const double, 16>(numbers));
  if (!pose) table.fail("is not a rigid transform; remove the file if the pose is unknown");
  return *pose;
}

std::optional<Pose> rigid_pose(std::span<const double, 16> row_major) {
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(row_major.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const Eigen::RowVector4d last(0.0, 0.0, 0.0, 1.0);
  const bool rigid = matrix.allFinite() && (R * R.transpose()).isIdentity(kRotationTolerance) &&
                     R.determinant() > 0.0 && (matrix.row(3) - last).norm() < kRotationTolerance;
  if (!rigid) return std::nullopt;
  return Pose::from_matrix(matrix);
}

}  // namespace stillpoint::datasets
