// SPDX-License-Identifier: BSD-3-Clause
/// The direction of gravity as a state with two degrees of freedom; its norm is constant.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillpoint {

/// Basis B(g) of the tangent plane of the sphere at gravity g, 3x2, orthonormal. With n = -g / |g|, which
/// points up, it is the minimal rotation that takes e_z to n, applied to e_x and e_y:
///
///   B(g) = [ 1 - n_x^2 / (1 + n_z)    -n_x n_y / (1 + n_z)   ]
///          [ -n_x n_y / (1 + n_z)     1 - n_y^2 / (1 + n_z)  ]
///          [ -n_x                     -n_y                   ]
///
/// It is smooth except at g along +z. The world of the odometry is level up to the error of its
/// initialization, so g is close to -z.
[[nodiscard]] Eigen::Matrix<double, 3, 2> gravity_basis(const Eigen::Vector3d& gravity);

/// g [+] d = Exp(B(g) d) g: rotates gravity by the tangent vector `d` [rad].
[[nodiscard]] Eigen::Vector3d rotate_gravity(const Eigen::Vector3d& gravity, const Eigen::Vector2d& d);

/// g [-] origin: the tangent vector d at `origin` [rad] with origin [+] d = g. Both of the same norm, not
/// opposite.
[[nodiscard]] Eigen::Vector2d gravity_difference(const Eigen::Vector3d& gravity,
                                                 const Eigen::Vector3d& origin);

/// d (g [+] d) / dd at d = 0: -[g]x B(g).
[[nodiscard]] Eigen::Matrix<double, 3, 2> gravity_jacobian(const Eigen::Vector3d& gravity);

/// The rotation by the smallest angle that takes gravity to -z; by half a turn about x if gravity is along
/// +z.
[[nodiscard]] Eigen::Quaterniond level_rotation(const Eigen::Vector3d& gravity);

}  // namespace stillpoint
