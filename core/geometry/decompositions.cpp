// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/decompositions.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace stillpoint {
namespace {

// Of any size up to a largest one, without memory from the heap.
template <int MaxSize>
using BoundedMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, MaxSize, MaxSize>;
}  // namespace

void detail::solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A,
                             const Eigen::Ref<const Eigen::MatrixXd>& b, Eigen::Ref<Eigen::MatrixXd> x) {
  const BoundedMatrix<7> matrix = A;
  const BoundedMatrix<7> right = b;
  x = matrix.ldlt().solve(right);
}

void detail::inverse_root(const Eigen::Ref<const Eigen::MatrixXd>& P, Eigen::Ref<Eigen::MatrixXd> W) {
  const BoundedMatrix<7> matrix = P;
  const Eigen::LLT<BoundedMatrix<7>> factor(matrix);
  W.setZero();
  if (factor.info() != Eigen::Success) return;
  W.setIdentity();
  factor.matrixL().solveInPlace(W);
}

void detail::propagate(const Eigen::Ref<const Eigen::MatrixXd>& J, const Eigen::Ref<const Eigen::MatrixXd>& P,
                       Eigen::Ref<Eigen::MatrixXd> result) {
  const BoundedMatrix<18> product = J.lazyProduct(P);
  result = product.lazyProduct(J.transpose());
}

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
