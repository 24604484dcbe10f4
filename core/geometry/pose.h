// SPDX-License-Identifier: BSD-3-Clause
/// Rigid transforms. `Pose T_a_b` maps coordinates from frame b to frame a: p_a = T_a_b * p_b.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillpoint {

static_assert(alignof(Eigen::Quaterniond) == 16,
              "compile with EIGEN_MAX_ALIGN_BYTES=16: the library is, and both must lay out poses alike");
static_assert(
    EIGEN_MALLOC_ALREADY_ALIGNED == 0,
    "compile with EIGEN_MALLOC_ALREADY_ALIGNED=0: the library is, and both must free matrices alike");

/// Rotation and translation [m]; code that sets `q` must keep it normalized.
struct Pose {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  [[nodiscard]] Pose inverse() const;
  [[nodiscard]] Eigen::Matrix3d R() const { return q.toRotationMatrix(); }

  [[nodiscard]] static Pose from_matrix(const Eigen::Matrix4d& matrix);
  [[nodiscard]] Eigen::Matrix4d matrix() const;
};

/// Composition: T_a_c = T_a_b * T_b_c.
[[nodiscard]] Pose operator*(const Pose& T_a_b, const Pose& T_b_c);

/// Transforms a point: p_a = R_a_b p_b + t_a_b.
[[nodiscard]] inline Eigen::Vector3d operator*(const Pose& T_a_b, const Eigen::Vector3d& p_b) {
  return T_a_b.q * p_b + T_a_b.p;
}

/// Pose between `a` (s = 0) and `b` (s = 1): slerp of the rotation, linear interpolation of the position.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double s);

}  // namespace stillpoint
