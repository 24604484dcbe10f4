// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/linear_prior.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "core/backend/factors/gravity_direction.h"
#include "core/config/backend_config.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// Of a prior.
constexpr int kMaxSize = kFrameColumns * (kMaxWindowSize + 1) + kGlobalColumns;

}  // namespace

void displace_block(BlockKind kind, const double* d, double* x) {
  if (kind == BlockKind::kGravity) {
    Eigen::Map<Eigen::Vector3d> g(x);
    g = rotate_gravity(g, Eigen::Vector2d(d));
    return;
  }
  const bool is_pose = global_size(kind) == 7;
  const int summed = is_pose ? 3 : global_size(kind);
  Eigen::Map<BlockVector>(x, summed) += Eigen::Map<const BlockVector>(d, summed);
  if (!is_pose) return;
  Eigen::Map<Eigen::Quaterniond> q(x + 3);
  q = (q * exp_so3(Eigen::Vector3d(d + 3))).normalized();
}

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

void add_random_step(BlockKind kind, std::span<const double> sigmas, LinearPrior& prior) {
  int column = 0;
  for (const PriorBlock& block : prior.blocks) {
    if (block.kind == kind) break;
    column += local_size(block.kind);
  }
  if (column == prior.jacobian.cols()) return;
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSize, 1> direction;
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    direction = prior.jacobian.col(column + static_cast<Eigen::Index>(i));
    const double squared = direction.squaredNorm();
    if (squared == 0.0 || sigmas[i] == 0.0) continue;
    const double reduction = (1.0 - 1.0 / std::sqrt(1.0 + sigmas[i] * sigmas[i] * squared)) / squared;
    for (Eigen::Index j = 0; j < prior.jacobian.cols(); ++j) {
      const double along = direction.dot(prior.jacobian.col(j));
      prior.jacobian.col(j) -= (reduction * along) * direction;
    }
    const double along = direction.dot(prior.residual);
    prior.residual -= (reduction * along) * direction;
  }
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
