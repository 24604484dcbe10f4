// SPDX-License-Identifier: BSD-3-Clause
/// Covariances of poses that other systems write, in rows with a stamp [s, or ns as in trajectories]:
///    6 numbers: variances of x y z [m^2] and of the rotation about x y z [rad^2]
///   12 numbers: upper triangles of the covariances of rotation, then position (OpenVINS ov_eval); the
///   rotation is
///               that of the body, R_w_b Exp(e)
///   21 numbers: upper triangle, row by row, of the 6x6 matrix of position and rotation (ROS)
///   36 numbers: this matrix
/// Without note, the rotation error is that about the axes of the world, Exp(e) R_w_b.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/error.h"
#include "core/base/timestamp.h"
#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// The covariance of one pose. Correlations of position and rotation are not used.
struct StampedCovariance {
  Timestamp t;
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero();  ///< [m^2]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();  ///< [rad^2]
};

struct CovarianceTable {
  std::vector<StampedCovariance> rows;  ///< in the order of the file
  std::size_t columns = 0;              ///< 6, 12, 21 or 36
  bool rotation_of_body = false;
};

/// The covariance of a 6x6 matrix (position, rotation), row by row.
[[nodiscard]] StampedCovariance covariance_of(Timestamp t, std::span<const double, 36> matrix);

/// Covariances in the columns after those of the pose, `t tx ty tz qx qy qz qw`.
/// @param text of a trajectory
/// @param name of the file, for messages
/// @return nullopt if there is another number of columns, or if they are no covariances: of each row, they
/// are positive semidefinite or all 0, and not all rows are 0
[[nodiscard]] std::optional<CovarianceTable> find_covariances(std::string_view text, const std::string& name);

/// Why columns after those of the pose are not used that are covariances in most rows.
/// @param text of a trajectory in which `find_covariances` finds none
/// @param name of the file, for messages
/// @return the error of the first row that has none, with its line; nullopt if the columns are something else
[[nodiscard]] std::optional<InputError> fault_in_covariances(std::string_view text, const std::string& name);

/// A file of rows `t` and covariance.
/// @throws InputError with file and line for another number of columns, or what is no covariance
[[nodiscard]] CovarianceTable parse_covariances(std::string_view text, const std::string& name);

/// The covariances at the times of the poses (less than 1 ms apart), with the rotation in the world frame;
/// zero where the table has none.
[[nodiscard]] std::vector<StampedCovariance> at_poses(const Trajectory& trajectory, CovarianceTable table);

}  // namespace stillpoint::eval
