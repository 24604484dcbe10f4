// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/pose_row.h"

#include <array>
#include <cmath>

#include "eval/io/text_reader.h"

namespace stillpoint {
namespace {

constexpr double kLengthTolerance = 0.1;  // files with 3 decimals are off by 0.1 %; more is no quaternion
constexpr double kMaxCoordinate = 1e9;    // [m]; beyond it a sum of squares loses its meaning

std::string quoted(std::string_view field) {
  constexpr std::size_t kShown = 40;
  return "\"" + std::string(field.substr(0, kShown)) + (field.size() > kShown ? "...\"" : "\"");
}

}  // namespace

Timestamp require_stamp(std::string_view field, const RowPlace& place) {
  const std::optional<Timestamp> t = parse_stamp(field);
  if (t) return *t;
  if (parse_number(field).value_or(0.0) > 1.0) {
    throw place.error("stamp " + quoted(field) + " is beyond 292 years; nanoseconds instead of seconds?");
  }
  throw place.error("stamp " + quoted(field) + " is not a number of seconds");
}

std::optional<Pose> parse_pose(std::span<const std::string_view> fields, QuaternionOrder order,
                               const RowPlace& place) {
  std::array<double, 7> v{};
  bool finite = true;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::optional<double> value = parse_number(fields[i]);
    if (!value) throw place.error(quoted(fields[i]) + " is not a number");
    v[i] = *value;
    finite = finite && std::isfinite(v[i]);
  }
  if (!finite) return std::nullopt;
  const Eigen::Quaterniond q = order == QuaternionOrder::kXyzw ? Eigen::Quaterniond(v[6], v[3], v[4], v[5])
                                                               : Eigen::Quaterniond(v[3], v[4], v[5], v[6]);
  const double length = q.norm();
  if (length == 0.0) return std::nullopt;
  if (std::abs(length - 1.0) > kLengthTolerance) {
    throw place.error("quaternion of length " + std::to_string(length) +
                      " is no rotation; are the columns in the order of the format?");
  }
  const Eigen::Vector3d p(v[0], v[1], v[2]);
  if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    throw place.error("position is more than 1e9 m from the origin; is the file in metres?");
  }
  return Pose{Eigen::Quaterniond(q.coeffs() / length), p};
}

void append_row(LoadedTrajectory& loaded, Timestamp t, const std::optional<Pose>& pose,
                const RowPlace& place) {
  std::vector<StampedPose>& poses = loaded.trajectory.poses;
  if (!pose) {
    ++loaded.skipped_rows;
    return;
  }
  if (!poses.empty() && t <= poses.back().t) {
    throw place.error("stamp " + format_stamp(t) + " s does not rise after " + format_stamp(poses.back().t) +
                      " s; sort the file and remove repeated stamps");
  }
  poses.push_back({t, *pose});
}

void require_poses(const LoadedTrajectory& loaded, const std::string& file) {
  if (!loaded.trajectory.poses.empty()) return;
  throw InputError(file, loaded.skipped_rows > 0
                             ? "no row is a pose: every one holds NaN or a zero quaternion"
                             : "holds no pose; expected rows \"t tx ty tz qx qy qz qw\"");
}

}  // namespace stillpoint
