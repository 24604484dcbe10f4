// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_consistency.h"

#include <algorithm>
#include <numbers>

#include "core/geometry/covariance.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Random walk; see the header. Between the drifts of a rendered sequence (a third) and of a recorded one
// (eight times as much).
constexpr double kDrift_m_per_sqrt_m = 0.01;
constexpr double kDrift_deg_per_sqrt_m = 0.1;
constexpr double kDrift_deg_per_sqrt_s = 0.02;
constexpr double kMinStepSigma_m = 0.002;
constexpr double kMinStepSigma_rad = 0.02 * kDegree;
constexpr double kWindowFactor = 3.0;  // ratio of the errors to their sigma, see reports/measured/loops.md
constexpr double kMaxWindowSigma_m = 0.01;
constexpr double kMaxWindowSigma_rad = 0.3 * kDegree;
constexpr double kUnknown_m = 1000.0;
constexpr double kUnknown_rad = 10.0;

double squared(double value) { return value * value; }

/// Isotropic covariance of position and rotation.
Matrix6 diagonal(double position, double rotation) {
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(position), Eigen::Vector3d::Constant(rotation);
  return covariance;
}

/// The covariance, scaled down to the largest standard deviations.
Matrix6 limited(const Matrix6& covariance) {
  const double sigma_m = largest_sigma(covariance.topLeftCorner<3, 3>());
  const double sigma_rad = largest_sigma(covariance.bottomRightCorner<3, 3>());
  const double scale = std::min({1.0, kMaxWindowSigma_m / sigma_m, kMaxWindowSigma_rad / sigma_rad});
  return squared(scale) * covariance;
}

}  // namespace

void OdometryDrift::add(Timestamp t, const Pose& T_w_b, const std::optional<Matrix6>& motion_covariance) {
  append(t, T_w_b, steps_.empty() ? Matrix6(Matrix6::Zero()) : step(t, T_w_b, motion_covariance));
}

void OdometryDrift::add_unrelated(Timestamp t, const Pose& T_w_b) {
  append(t, T_w_b,
         steps_.empty() ? Matrix6(Matrix6::Zero()) : diagonal(squared(kUnknown_m), squared(kUnknown_rad)));
}

void OdometryDrift::append(Timestamp t, const Pose& T_w_b, const Matrix6& step) {
  Matrix6 sum = step;
  if (!sums_.empty()) {
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = T_w_b_.back().R();
    J.topRightCorner<3, 3>() = skew(T_w_b.p) * T_w_b.R();
    J.bottomRightCorner<3, 3>() = T_w_b.R();
    sum = sums_.back() + propagate(J, step);
  }
  times_.push_back(t);
  T_w_b_.push_back(T_w_b);
  steps_.push_back(step);
  sums_.push_back(sum);
}

Matrix6 OdometryDrift::step(Timestamp t, const Pose& T_w_b,
                            const std::optional<Matrix6>& motion_covariance) const {
  const double distance_m = (T_w_b.p - T_w_b_.back().p).norm();
  // A map may contain several runs, each with a clock of its own.
  const double elapsed_s = std::max(0.0, seconds_between(times_.back(), t));
  const double position = squared(kDrift_m_per_sqrt_m) * distance_m + squared(kMinStepSigma_m);
  const double rotation = squared(kDegree * kDrift_deg_per_sqrt_m) * distance_m +
                          squared(kDegree * kDrift_deg_per_sqrt_s) * elapsed_s + squared(kMinStepSigma_rad);
  const Matrix6 walk = diagonal(position, rotation);
  return motion_covariance ? Matrix6(walk + squared(kWindowFactor) * limited(*motion_covariance)) : walk;
}

Matrix6 OdometryDrift::covariance(std::size_t i, std::size_t j) const {
  const Eigen::Matrix3d R_i_w = T_w_b_[i].R().transpose();
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = R_i_w;
  J.topRightCorner<3, 3>() = -R_i_w * skew(T_w_b_[j].p);
  J.bottomRightCorner<3, 3>() = T_w_b_[j].R().transpose();
  return J * (sums_[j] - sums_[i]) * J.transpose();
}

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
