// SPDX-License-Identifier: BSD-3-Clause
/// Writes a trajectory as a topic of a bag.
#pragma once

#include <span>

#include "core/types/trajectory.h"
#include "datasets/bags/bag_geometry.h"
#include "eval/io/covariance_file.h"

namespace stillpoint::datasets {

enum class TrajectoryMessage {
  kPose,      ///< geometry_msgs/PoseStamped, or PoseWithCovarianceStamped with covariances
  kOdometry,  ///< nav_msgs/Odometry of the frame "body"; velocities, which trajectories lack, are 0
};

/// A new bag with one topic in the frame "world". `read_bag_trajectory` reads the same poses.
/// @param target the container follows from the name, see `BagWriter`
/// @param trajectory poses in order of time
/// @param covariances empty, or one per pose
/// @throws InputError if the bag cannot be created or completed
void write_bag_trajectory(const BagTopic& target, const Trajectory& trajectory,
                          std::span<const eval::StampedCovariance> covariances = {},
                          TrajectoryMessage message = TrajectoryMessage::kPose);

}  // namespace stillpoint::datasets
