// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/so3.h"

#include <cmath>

namespace stillpoint {
namespace {

constexpr double kSmallAngle = 1e-5;  // [rad]; below it the Taylor series are exact to machine precision

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& theta) {
  const double angle = theta.norm();
  const double half = 0.5 * angle;
  const double scale = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = scale * theta;
  return q;
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;  // q and -q are the same rotation; use the shorter one
  const double sine = q.vec().norm();
  if (sine < kSmallAngle) return 2.0 * sign * (1.0 + sine * sine / 6.0) * q.vec();
  return sign * (2.0 * std::atan2(sine, sign * q.w()) / sine) * q.vec();
}

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& theta) {
  const double angle = theta.norm();
  const Eigen::Matrix3d cross = skew(theta);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() - 0.5 * cross + cross * cross / 6.0;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / squared * cross +
         (angle - std::sin(angle)) / (squared * angle) * cross * cross;
}

Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& theta) {
  const double angle = theta.norm();
  const Eigen::Matrix3d cross = skew(theta);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * cross + cross * cross / 12.0;
  const double half = 0.5 * angle;
  const double factor = (1.0 - half * std::cos(half) / std::sin(half)) / (angle * angle);
  return Eigen::Matrix3d::Identity() + 0.5 * cross + factor * cross * cross;
}

}  // namespace stillpoint
