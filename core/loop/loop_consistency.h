// SPDX-License-Identifier: BSD-3-Clause
/// Consistency of a loop with the odometry and with other loops: aliased places pass any check of a single
/// pair of images.
#pragma once

#include <span>

#include "core/loop/loop_verification.h"
#include "core/loop/odometry_drift.h"

namespace stillpoint {

/// A verified loop between two keyframes of the graph.
struct GraphLoop {
  int match = 0;
  int query = 0;
  Pose T_bm_bq;
  Matrix6 covariance = Matrix6::Identity();  ///< p + rho, q * Exp(theta)
};

/// The loop from another query: T_bm_bk = T_bm_bq T_bq_bk.
/// @param query the keyframe k
/// @param covariance of `T_bq_bk`: p + rho, q * Exp(theta)
[[nodiscard]] GraphLoop with_query(const GraphLoop& loop, int query, const Pose& T_bq_bk,
                                   const Matrix6& covariance);

/// Squared Mahalanobis distance between a loop and the motion of the odometry. Chi-square distributed with 6
/// degrees of freedom if the loop is true.
/// @param T_w_b poses of the keyframes by the odometry
[[nodiscard]] double odometry_distance(const GraphLoop& loop, std::span<const Pose> T_w_b,
                                       const OdometryDrift& drift);

/// Squared Mahalanobis distance between two loops (Mangelson et al. 2018, Eq. (3)): of the cycle
///
///   T_q_q' T_q'_m' T_m'_m T_m_q
///
/// from the identity, where the motions q to q' and m to m' are those of the odometry, so that only the drift
/// over these short parts enters, and not that over the loops.
/// @param T_w_b poses of the keyframes by the odometry
[[nodiscard]] double pairwise_distance(const GraphLoop& a, const GraphLoop& b, std::span<const Pose> T_w_b,
                                       const OdometryDrift& drift);

}  // namespace stillpoint
