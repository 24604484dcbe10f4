// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/pose_row.h"

#include <array>
#include <cmath>

#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

constexpr double kNormTolerance = 0.1;  // rounding to 3 decimals changes the norm by 0.1 % only
constexpr double kMaxCoordinate = 1e9;  // [m]; limits the loss of precision in sums of squares

std::string quoted(std::string_view field) {
  constexpr std::size_t kMaxLength = 40;
  return "\"" + std::string(field.substr(0, kMaxLength)) + (field.size() > kMaxLength ? "...\"" : "\"");
}

}  // namespace

Timestamp require_stamp(std::string_view field, const RowLocation& location) {
  const std::optional<Timestamp> t = parse_stamp(field);
  if (t) return *t;
  if (parse_number(field).value_or(0.0) > 1.0) {
    throw location.error("stamp " + quoted(field) +
                         " exceeds 292 years; is it in nanoseconds instead of seconds?");
  }
  throw location.error("stamp " + quoted(field) + " is not a number of seconds");
}

std::optional<Pose> parse_pose(std::span<const std::string_view> fields, QuaternionOrder order,
                               const RowLocation& location) {
  std::array<double, 7> v{};
  bool finite = true;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::optional<double> value = parse_number(fields[i]);
    if (!value) throw location.error(quoted(fields[i]) + " is not a number");
    v[i] = *value;
    finite = finite && std::isfinite(v[i]);
  }
  if (!finite) return std::nullopt;
  const Eigen::Quaterniond q = order == QuaternionOrder::kXyzw ? Eigen::Quaterniond(v[6], v[3], v[4], v[5])
                                                               : Eigen::Quaterniond(v[3], v[4], v[5], v[6]);
  const double norm = q.norm();
  if (norm == 0.0) return std::nullopt;
  if (std::abs(norm - 1.0) > kNormTolerance) {
    throw location.error("quaternion of norm " + std::to_string(norm) +
                         " is not a rotation; check the order of the columns");
  }
  const Eigen::Vector3d p(v[0], v[1], v[2]);
  if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    throw location.error("position exceeds 1e9 m; is the file in meters?");
  }
  return Pose{Eigen::Quaterniond(q.coeffs() / norm), p};
}

void append_row(LoadedTrajectory& loaded, Timestamp t, const std::optional<Pose>& pose,
                const RowLocation& location) {
  std::vector<StampedPose>& poses = loaded.trajectory.poses;
  if (!pose) {
    ++loaded.skipped_rows;
    return;
  }
  if (!poses.empty() && t <= poses.back().t) {
    throw location.error("stamp " + format_stamp(t) + " s does not increase; the previous one is " +
                         format_stamp(poses.back().t) + " s; sort the file and remove duplicate stamps");
  }
  poses.push_back({t, *pose});
}

void require_poses(const LoadedTrajectory& loaded, const std::string& file) {
  if (!loaded.trajectory.poses.empty()) return;
  throw InputError(file, loaded.skipped_rows > 0
                             ? "no valid pose: all rows have NaN or a zero quaternion"
                             : "no poses found; expected rows \"t tx ty tz qx qy qz qw\"");
}

}  // namespace stillpoint::eval
