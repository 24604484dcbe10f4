// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/odometry_drift.h"

#include <algorithm>
#include <numbers>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMinStepSigma_m = 0.002;
constexpr double kMinStepSigma_rad = 0.02 * kDegree;
constexpr double kUnknown_m = 1000.0;
constexpr double kUnknown_rad = 10.0;

double squared(double value) { return value * value; }

}  // namespace

void OdometryDrift::add(Timestamp t, const Pose& T_w_b) {
  times_.push_back(t);
  T_w_b_.push_back(T_w_b);
  if (sums_.empty()) {
    sums_.emplace_back(Matrix6::Zero());
    return;
  }
  const Pose& before = T_w_b_[T_w_b_.size() - 2];
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = before.R();
  J.topRightCorner<3, 3>() = skew(T_w_b.p) * T_w_b.R();
  J.bottomRightCorner<3, 3>() = T_w_b.R();
  sums_.emplace_back(sums_.back() + J * step_covariance(T_w_b_.size() - 1) * J.transpose());
}

void OdometryDrift::add_unrelated(Timestamp t, const Pose& T_w_b) {
  unrelated_ = T_w_b_.size();
  add(t, T_w_b);
}

Matrix6 OdometryDrift::step_covariance(std::size_t k) const {
  if (k == unrelated_) {
    Matrix6 unknown = Matrix6::Zero();
    unknown.diagonal() << Eigen::Vector3d::Constant(squared(kUnknown_m)),
        Eigen::Vector3d::Constant(squared(kUnknown_rad));
    return unknown;
  }
  const double distance_m = (T_w_b_[k].p - T_w_b_[k - 1].p).norm();
  // A map may contain several runs, each with a clock of its own.
  const double elapsed_s = std::max(0.0, seconds_between(times_[k - 1], times_[k]));
  const double position = squared(config_.drift_m_per_sqrt_m) * distance_m + squared(kMinStepSigma_m);
  const double rotation = squared(kDegree * config_.drift_deg_per_sqrt_m) * distance_m +
                          squared(kDegree * config_.drift_deg_per_sqrt_s) * elapsed_s +
                          squared(kMinStepSigma_rad);
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << position, position, position, rotation, rotation, rotation;
  return covariance;
}

Matrix6 OdometryDrift::covariance(std::size_t i, std::size_t j) const {
  const Eigen::Matrix3d R_i_w = T_w_b_[i].R().transpose();
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = R_i_w;
  J.topRightCorner<3, 3>() = -R_i_w * skew(T_w_b_[j].p);
  J.bottomRightCorner<3, 3>() = T_w_b_[j].R().transpose();
  return J * (sums_[j] - sums_[i]) * J.transpose();
}

}  // namespace stillpoint
