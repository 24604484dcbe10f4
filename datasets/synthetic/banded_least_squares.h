// SPDX-License-Identifier: BSD-3-Clause
/// Linear least squares whose rows touch a few neighbouring unknowns only, as in spline fitting.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace stillpoint {

/// Sums normal equations in a band below the diagonal, and solves them by Cholesky (Golub and Van Loan, 4.3).
class BandedLeastSquares {
 public:
  /// @param unknowns  count @param band  widest row @param columns  right-hand sides
  BandedLeastSquares(int unknowns, int band, int columns);

  /// Adds weight * |row * x[first, first + row.size()) - value|^2 for each column of x; `value` has one
  /// number per column.
  void add(int first, std::span<const double> row, std::span<const double> value, double weight);

  /// @return unknowns x columns. The rows added must determine every unknown.
  [[nodiscard]] Eigen::MatrixXd solve() const;

 private:
  Eigen::MatrixXd normal_;  // (i - j, j) holds entry (i, j), i >= j
  Eigen::MatrixXd right_;
};

}  // namespace stillpoint
