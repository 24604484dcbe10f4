// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_consistency.h"

namespace stillpoint {
namespace {

UncertainPose motion(int from, int to, std::span<const Pose> T_w_b, const OdometryDrift& drift) {
  if (from > to) return inverse(motion(to, from, T_w_b, drift));
  const auto i = static_cast<std::size_t>(from);
  const auto j = static_cast<std::size_t>(to);
  if (i == j) return {};
  return {.T_w_f = T_w_b[i].inverse() * T_w_b[j], .covariance = drift.covariance(i, j)};
}

double distance_from_identity(const UncertainPose& cycle) {
  return squared_distance({}, cycle.T_w_f, cycle.covariance);
}

}  // namespace

GraphLoop with_query(const GraphLoop& loop, int query, const Pose& T_bq_bk, const Matrix6& covariance) {
  const UncertainPose moved = compose({.T_w_f = loop.T_bm_bq, .covariance = loop.covariance},
                                      {.T_w_f = T_bq_bk, .covariance = covariance});
  return {.match = loop.match, .query = query, .T_bm_bq = moved.T_w_f, .covariance = moved.covariance};
}

double odometry_distance(const GraphLoop& loop, std::span<const Pose> T_w_b, const OdometryDrift& drift) {
  const UncertainPose measured{.T_w_f = loop.T_bm_bq, .covariance = loop.covariance};
  return distance_from_identity(compose(inverse(motion(loop.match, loop.query, T_w_b, drift)), measured));
}

double pairwise_distance(const GraphLoop& a, const GraphLoop& b, std::span<const Pose> T_w_b,
                         const OdometryDrift& drift) {
  const UncertainPose T_m_q{.T_w_f = a.T_bm_bq, .covariance = a.covariance};
  const UncertainPose T_m2_q2{.T_w_f = b.T_bm_bq, .covariance = b.covariance};
  const UncertainPose around = compose(compose(motion(a.match, b.match, T_w_b, drift), T_m2_q2),
                                       motion(b.query, a.query, T_w_b, drift));
  return distance_from_identity(compose(inverse(T_m_q), around));
}

}  // namespace stillpoint
