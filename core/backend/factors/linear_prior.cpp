// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/linear_prior.h"

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/so3.h"

namespace stillpoint {

BlockVector block_difference(BlockKind kind, const double* x, const BlockVector& origin) {
  const int size = global_size(kind);
  const Eigen::Map<const BlockVector> value(x, size);
  if (kind == BlockKind::kGravity) {
    return gravity_difference(Eigen::Vector3d(x), Eigen::Vector3d(origin.head<3>()));
  }
  if (size != 7) return value - origin;

  const Eigen::Quaterniond q(x + 3);
  const Eigen::Quaterniond q_origin(origin.data() + 3);
  BlockVector difference(6);
  difference.head<3>() = value.head<3>() - origin.head<3>();
  difference.tail<3>() = log_so3(q_origin.conjugate() * q);
  return difference;
}

std::optional<Eigen::Matrix2d> gravity_covariance(const LinearPrior& prior) {
  Eigen::Index column = 0;
  for (const PriorBlock& block : prior.blocks) {
    if (block.kind == BlockKind::kGravity) {
      const Eigen::MatrixXd J = prior.jacobian;
      if (!J.allFinite()) return std::nullopt;
      const Eigen::MatrixXd root = J.completeOrthogonalDecomposition().pseudoInverse().middleRows<2>(column);
      return root * root.transpose();
    }
    column += local_size(block.kind);
  }
  return std::nullopt;
}

}  // namespace stillpoint
