// SPDX-License-Identifier: BSD-3-Clause
/// Cholesky factorisation of a symmetric matrix whose rows begin late (George and Liu 1981, Sec. 4.3).
#pragma once

#include <span>

#include <Eigen/Core>

namespace stillpoint {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows are taken in tiles of this many; sizes are multiples of it.
inline constexpr int kTile = 3;

/// Factorises the lower triangle of `S` in place, S = L L^T; the diagonal of the result holds 1 / L_ii.
/// @param first column of the first entry in each tile of rows, a multiple of kTile; what lies before is zero
///   and stays untouched
/// @return false when a pivot is not positive: S is then spoilt
[[nodiscard]] bool skyline_factorize(std::span<const int> first, Eigen::Ref<RowMajorMatrix> S);

/// Turns x into L^-1 x.
void skyline_forward(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor,
                     Eigen::Ref<Eigen::VectorXd> x);

/// Turns x into S^-1 x by the factor.
void skyline_solve(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor,
                   Eigen::Ref<Eigen::VectorXd> x);

}  // namespace stillpoint
