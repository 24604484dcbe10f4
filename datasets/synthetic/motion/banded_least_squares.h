// SPDX-License-Identifier: BSD-3-Clause
/// Linear least squares with a banded normal matrix, as in spline fitting.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace stillpoint::synth {

/// Accumulates the normal equations A^T W A x = A^T W b in band storage and solves them by banded Cholesky
/// factorization (Golub and Van Loan, 4.3).
class BandedLeastSquares {
 public:
  /// @param unknowns number of unknowns @param band maximum row length @param columns number of right-hand
  /// sides
  BandedLeastSquares(int unknowns, int band, int columns);

  /// Adds weight * |row * x[first, first + row.size()) - value|^2 for each column of x; `value` has one
  /// number per column.
  void add(int first, std::span<const double> row, std::span<const double> value, double weight);

  /// @return unknowns x columns. The rows added must determine every unknown.
  [[nodiscard]] Eigen::MatrixXd solve() const;

 private:
  Eigen::MatrixXd normal_;  // (i - j, j) holds entry (i, j), i >= j
  Eigen::MatrixXd rhs_;
};

}  // namespace stillpoint::synth
