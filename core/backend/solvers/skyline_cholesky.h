// SPDX-License-Identifier: BSD-3-Clause
/// Cholesky factorization of a symmetric matrix in skyline (envelope) storage (George and Liu 1981, Sec.
/// 4.3).
#pragma once

#include <span>

#include <Eigen/Core>

namespace stillpoint {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows are processed in tiles of this size; matrix sizes are multiples of it.
inline constexpr int kTile = 3;

/// Factorizes the lower triangle of `S` in place, S = L L^T; the diagonal of the result holds 1 / L_ii.
/// @param first column of the first nonzero in each tile of rows, a multiple of kTile; entries before it are
/// zero
///   and not accessed
/// @return false if a pivot is not positive: S is then undefined
[[nodiscard]] bool skyline_factorize(std::span<const int> first, Eigen::Ref<RowMajorMatrix> S);

/// x <- L^-1 x.
void skyline_forward(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor,
                     Eigen::Ref<Eigen::VectorXd> x);

/// Several right-hand sides; unused columns are zero.
using ForwardColumns = Eigen::Matrix<double, Eigen::Dynamic, 32, Eigen::RowMajor>;

/// X <- L^-1 X. Rows of X before `begin` are zero; a multiple of kTile.
void skyline_forward(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor, int begin,
                     Eigen::Map<ForwardColumns> X);

/// x <- S^-1 x = L^-T L^-1 x.
void skyline_solve(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor,
                   Eigen::Ref<Eigen::VectorXd> x);

}  // namespace stillpoint
