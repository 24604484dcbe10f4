// SPDX-License-Identifier: BSD-3-Clause
/// Size of the uncertainty that a covariance matrix describes.
#pragma once

#include <Eigen/Core>

namespace stillpoint {

/// Standard deviation along the least certain direction: the square root of the largest eigenvalue, or 0 if
/// rounding made that negative.
/// @param covariance symmetric; its lower triangle is used. The result has the unit of its square root.
[[nodiscard]] double largest_sigma(const Eigen::Matrix3d& covariance);

}  // namespace stillpoint
