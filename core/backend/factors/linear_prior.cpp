// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/linear_prior.h"

#include <Eigen/Geometry>

#include "core/geometry/so3.h"

namespace stillpoint {

BlockVector block_difference(BlockKind kind, const double* x, const BlockVector& origin) {
  const int size = global_size(kind);
  const Eigen::Map<const BlockVector> value(x, size);
  if (size != 7) return value - origin;

  const Eigen::Quaterniond q(x + 3);
  const Eigen::Quaterniond q_origin(origin.data() + 3);
  BlockVector difference(6);
  difference.head<3>() = value.head<3>() - origin.head<3>();
  difference.tail<3>() = log_so3(q_origin.conjugate() * q);
  return difference;
}

}  // namespace stillpoint
