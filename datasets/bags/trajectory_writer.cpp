// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/trajectory_writer.h"

#include <array>

namespace stillpoint::datasets {
namespace {

/// Position and rotation, row by row, without correlations of both.
std::array<double, 36> pose_covariance(const eval::StampedCovariance& covariance) {
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> matrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>::Zero();
  matrix.topLeftCorner<3, 3>() = covariance.position;
  matrix.bottomRightCorner<3, 3>() = covariance.rotation;
  std::array<double, 36> numbers{};
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data()) = matrix;
  return numbers;
}

}  // namespace

void write_bag_trajectory(const BagTopic& target, const Trajectory& trajectory,
                          std::span<const eval::StampedCovariance> covariances, TrajectoryMessage message) {
  const char* const type = message == TrajectoryMessage::kOdometry ? "nav_msgs/Odometry"
                           : covariances.empty()                   ? "geometry_msgs/PoseStamped"
                                                 : "geometry_msgs/PoseWithCovarianceStamped";
  BagWriter writer(target.bag, ChunkCompression::kNone);
  const std::uint32_t connection = writer.add_connection(target.topic, type);
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    const StampedPose& pose = trajectory.poses[i];
    PoseMessage content{.header = {.stamp = pose.t, .frame = "world"}, .child = "body", .pose = pose.T_w_f};
    if (!covariances.empty()) content.covariance = pose_covariance(covariances[i]);
    writer.write(connection, pose.t, serialize_pose(content, type, writer.format()));
  }
  writer.finish();
}

}  // namespace stillpoint::datasets
