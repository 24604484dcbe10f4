// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/gyro_bias.h"

#include <Eigen/Cholesky>

#include "core/base/error.h"
#include "core/geometry/so3.h"

namespace stillpoint {

Eigen::Vector3d estimate_gyro_bias(std::span<const RotationPair> pairs) {
  using Index = ImuErrorIndex;
  STILLPOINT_CHECK(!pairs.empty());
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d normal_vector = Eigen::Vector3d::Zero();
  for (const RotationPair& pair : pairs) {
    const Preintegration& imu = *pair.preintegration;
    const Eigen::Matrix3d J = imu.jacobian().block<3, 3>(Index::kRotation, Index::kGyroBias);
    const Eigen::Vector3d difference = log_so3(imu.delta_q(imu.gyro_bias()).conjugate() * pair.q_bi_bj);
    normal_matrix += J.transpose() * J;
    normal_vector += J.transpose() * (difference + J * imu.gyro_bias());
  }
  return normal_matrix.ldlt().solve(normal_vector);
}

}  // namespace stillpoint
