// SPDX-License-Identifier: BSD-3-Clause
/// Decompositions and products of small matrices. They are compiled here once, for all sizes: to instantiate
/// those of Eigen takes up to four seconds of compiling in each file and for each size.
#pragma once

#include <Eigen/Core>

namespace stillpoint {

template <int N>
using SquareMatrix = Eigen::Matrix<double, N, N>;

namespace detail {
void solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& b,
                     Eigen::Ref<Eigen::MatrixXd> x);
void inverse_root(const Eigen::Ref<const Eigen::MatrixXd>& P, Eigen::Ref<Eigen::MatrixXd> W);
void propagate(const Eigen::Ref<const Eigen::MatrixXd>& J, const Eigen::Ref<const Eigen::MatrixXd>& P,
               Eigen::Ref<Eigen::MatrixXd> result);
}  // namespace detail

/// Solution of A x = b by A = L D L^T with pivoting (Eigen::LDLT), for each of M columns; M, N <= 7.
/// @param A symmetric, semidefinite; its lower triangle is used
/// @param b right sides
/// @return not finite if A or b is not; zero in directions in which A is zero
template <int N, int M>
[[nodiscard]] Eigen::Matrix<double, N, M> solve_symmetric(const SquareMatrix<N>& A,
                                                          const Eigen::Matrix<double, N, M>& b) {
  Eigen::Matrix<double, N, M> x;
  detail::solve_symmetric(A, b, x);
  return x;
}

/// Square root W of the information, W^T W = P^-1, by which the error of a variable is divided: W = L^-1 with
/// the Cholesky factor of P = L L^T.
/// @param P covariance; its lower triangle is used; N <= 7
/// @return zero if P is not positive definite
template <int N>
[[nodiscard]] SquareMatrix<N> inverse_root(const SquareMatrix<N>& P) {
  SquareMatrix<N> W;
  detail::inverse_root(P, W);
  return W;
}

/// Covariance J P J^T of J x, with the covariance P of x (propagation of uncertainty); M, N <= 18.
template <int M, int N>
[[nodiscard]] SquareMatrix<M> propagate(const Eigen::Matrix<double, M, N>& J, const SquareMatrix<N>& P) {
  SquareMatrix<M> result;
  detail::propagate(J, P, result);
  return result;
}

/// Eigenvalues of a symmetric matrix in increasing order. With the mean m of the diagonal (a, c), those of
/// two rows are m -+ sqrt(((a - c) / 2)^2 + b^2).
/// @param A its lower triangle is used
[[nodiscard]] Eigen::Vector3d eigenvalues(const Eigen::Matrix3d& A);
[[nodiscard]] Eigen::Vector2d eigenvalues(const Eigen::Matrix2d& A);

/// The rotation R for which trace(R^T M) is largest, which maps vectors b to a with the least squared
/// distance for M = sum a b^T. With the singular value decomposition M = U S V^T (Umeyama 1991, Eq. (40) and
/// (43)):
///
///   R = U diag(1, 1, s) V^T,    s = det(U) det(V)
struct ClosestRotation {
  Eigen::Matrix3d R;
  Eigen::Vector3d singular;  ///< the decreasing diagonal of S, the last one times s: their sum is the trace
};
[[nodiscard]] ClosestRotation closest_rotation(const Eigen::Matrix3d& M);

}  // namespace stillpoint
