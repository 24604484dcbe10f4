// SPDX-License-Identifier: BSD-3-Clause
/// Decompositions of small matrices. They are compiled here once: to instantiate those of Eigen takes up to
/// two seconds of compiling in each file.
#pragma once

#include <Eigen/Core>

namespace stillpoint {

template <int N>
using SquareMatrix = Eigen::Matrix<double, N, N>;
template <int N>
using ColumnVector = Eigen::Matrix<double, N, 1>;

/// Solution of A x = b by A = L D L^T with pivoting (Eigen::LDLT); N is 3, 4, 6 or 7.
/// @param A symmetric, semidefinite; its lower triangle is used
/// @param b right side
/// @return not finite if A or b is not; zero in directions in which A is zero
template <int N>
[[nodiscard]] ColumnVector<N> solve_symmetric(const SquareMatrix<N>& A, const ColumnVector<N>& b);

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
