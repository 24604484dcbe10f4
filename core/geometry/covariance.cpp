// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/covariance.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace stillpoint {

double largest_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

}  // namespace stillpoint
