// SPDX-License-Identifier: BSD-3-Clause
/// Poses in the rows of a text table; common to all text formats of trajectories.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "eval/io/text_table.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

enum class QuaternionOrder { kXyzw, kWxyz };

/// Which rows are accepted.
enum class PoseCheck {
  kEstimate,     ///< the norm of the quaternion is within 0.1 of 1; a row without a pose is skipped
  kGroundTruth,  ///< the norm of the quaternion is within 0.01 of 1; every row must be a pose
};

/// Layout of the seven numbers of a pose: position, then quaternion.
struct PoseFields {
  std::size_t first = 1;  ///< index of tx
  QuaternionOrder order = QuaternionOrder::kXyzw;
  PoseCheck check = PoseCheck::kEstimate;
};

/// Parses a pose and normalizes its quaternion.
/// @return nullopt if the row has no pose (a value that is not finite, or a zero quaternion) and may be
/// skipped
/// @throws InputError if a field is not a number, the quaternion is not a rotation, or a coordinate exceeds
/// 1e9 m
[[nodiscard]] std::optional<Pose> parse_pose(const TextRow& row, const PoseFields& fields);

/// Collects the poses of a file in order of time.
class TrajectoryBuilder {
 public:
  /// Adds the pose of a row. A row without a pose, and one with the stamp of an earlier row, is counted and
  /// skipped; one that is up to `kMaxDisorder_s` earlier than the latest pose is counted and sorted in.
  /// @throws InputError if it is even earlier
  void add(const TextRow& row, Timestamp t, const std::optional<Pose>& pose);

  /// @param file its name, for messages
  /// @throws InputError if no pose was added
  void require_poses(const std::string& file) const;

  [[nodiscard]] LoadedTrajectory release() { return std::move(loaded_); }

 private:
  void sort_in(const TextRow& row, const StampedPose& pose);

  LoadedTrajectory loaded_;
};

}  // namespace stillpoint::eval
