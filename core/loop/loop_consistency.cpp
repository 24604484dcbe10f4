// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_consistency.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// Pose with the covariance of (p + rho, q * Exp(theta)).
struct UncertainPose {
  Pose T;
  Matrix6 covariance = Matrix6::Zero();
};

/// Composition of independent poses, first order:
///   rho = rho_a - R_a [p_b]x theta_a + R_a rho_b,   theta = R_b^T theta_a + theta_b
UncertainPose compose(const UncertainPose& a, const UncertainPose& b) {
  Matrix6 J_a = Matrix6::Identity();
  J_a.topRightCorner<3, 3>() = -a.T.R() * skew(b.T.p);
  J_a.bottomRightCorner<3, 3>() = b.T.R().transpose();
  Matrix6 J_b = Matrix6::Identity();
  J_b.topLeftCorner<3, 3>() = a.T.R();
  return {.T = a.T * b.T,
          .covariance = J_a * a.covariance * J_a.transpose() + J_b * b.covariance * J_b.transpose()};
}

/// The inverse: rho' = -R^T rho - [R^T p]x theta, theta' = -R theta.
UncertainPose inverse(const UncertainPose& a) {
  const Eigen::Matrix3d R_transposed = a.T.R().transpose();
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = -R_transposed;
  J.topRightCorner<3, 3>() = -skew(R_transposed * a.T.p);
  J.bottomRightCorner<3, 3>() = -a.T.R();
  return {.T = a.T.inverse(), .covariance = J * a.covariance * J.transpose()};
}

UncertainPose motion(int from, int to, std::span<const Pose> T_w_b, const OdometryDrift& drift) {
  if (from > to) return inverse(motion(to, from, T_w_b, drift));
  const auto i = static_cast<std::size_t>(from);
  const auto j = static_cast<std::size_t>(to);
  if (i == j) return {};
  return {.T = T_w_b[i].inverse() * T_w_b[j], .covariance = drift.covariance(i, j)};
}

/// Squared Mahalanobis distance of a pose from the identity.
double distance_from_identity(const UncertainPose& cycle) {
  Eigen::Matrix<double, 6, 1> error;
  error << cycle.T.p, log_so3(cycle.T.q);
  return error.dot(cycle.covariance.ldlt().solve(error));
}

}  // namespace

GraphLoop with_query(const GraphLoop& loop, int query, const Pose& T_bq_bk, const Matrix6& covariance) {
  const UncertainPose moved =
      compose({.T = loop.T_bm_bq, .covariance = loop.covariance}, {.T = T_bq_bk, .covariance = covariance});
  return {.match = loop.match, .query = query, .T_bm_bq = moved.T, .covariance = moved.covariance};
}

double odometry_distance(const GraphLoop& loop, std::span<const Pose> T_w_b, const OdometryDrift& drift) {
  const UncertainPose measured{.T = loop.T_bm_bq, .covariance = loop.covariance};
  return distance_from_identity(compose(inverse(motion(loop.match, loop.query, T_w_b, drift)), measured));
}

double pairwise_distance(const GraphLoop& a, const GraphLoop& b, std::span<const Pose> T_w_b,
                         const OdometryDrift& drift) {
  const UncertainPose T_m_q{.T = a.T_bm_bq, .covariance = a.covariance};
  const UncertainPose T_m2_q2{.T = b.T_bm_bq, .covariance = b.covariance};
  const UncertainPose around = compose(compose(motion(a.match, b.match, T_w_b, drift), T_m2_q2),
                                       motion(b.query, a.query, T_w_b, drift));
  return distance_from_identity(compose(inverse(T_m_q), around));
}

}  // namespace stillpoint
