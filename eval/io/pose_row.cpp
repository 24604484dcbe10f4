// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/pose_row.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint::eval {
namespace {

constexpr double kNormTolerance = 0.1;          // rounding to 3 decimals changes the norm by 0.1 % only
constexpr double kGroundTruthTolerance = 0.01;  // rounding to 4 decimals stays far below
constexpr double kMaxCoordinate = 1e9;          // [m]; limits the loss of precision in sums of squares

}  // namespace

std::optional<Pose> parse_pose(const TextRow& row, const PoseFields& fields) {
  const bool may_skip = fields.check == PoseCheck::kEstimate;
  std::array<double, 7> v{};
  bool finite = true;
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] = may_skip ? row.number(fields.first + i) : row.finite_number(fields.first + i);
    finite = finite && std::isfinite(v[i]);
  }
  if (!finite) return std::nullopt;
  const Eigen::Quaterniond q = fields.order == QuaternionOrder::kXyzw
                                   ? Eigen::Quaterniond(v[6], v[3], v[4], v[5])
                                   : Eigen::Quaterniond(v[3], v[4], v[5], v[6]);
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

}  // namespace stillpoint::eval
