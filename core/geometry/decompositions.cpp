// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/decompositions.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace stillpoint {

template <int N>
ColumnVector<N> solve_symmetric(const SquareMatrix<N>& A, const ColumnVector<N>& b) {
  return A.ldlt().solve(b);
}
template ColumnVector<3> solve_symmetric<3>(const SquareMatrix<3>&, const ColumnVector<3>&);
template ColumnVector<4> solve_symmetric<4>(const SquareMatrix<4>&, const ColumnVector<4>&);
template ColumnVector<6> solve_symmetric<6>(const SquareMatrix<6>&, const ColumnVector<6>&);
template ColumnVector<7> solve_symmetric<7>(const SquareMatrix<7>&, const ColumnVector<7>&);

Eigen::Vector3d eigenvalues(const Eigen::Matrix3d& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::Vector2d eigenvalues(const Eigen::Matrix2d& A) {
  const double mean = 0.5 * (A(0, 0) + A(1, 1));
  const double distance = std::hypot(0.5 * (A(0, 0) - A(1, 1)), A(1, 0));
  return {mean - distance, mean + distance};
}

ClosestRotation closest_rotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  return {svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose(),
          svd.singularValues().cwiseProduct(signs)};
}

}  // namespace stillpoint
