// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/banded_least_squares.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace stillpoint::synth {

BandedLeastSquares::BandedLeastSquares(int unknowns, int band, int columns)
    : normal_(Eigen::MatrixXd::Zero(band, unknowns)), rhs_(Eigen::MatrixXd::Zero(unknowns, columns)) {}

void BandedLeastSquares::add(int first, std::span<const double> row, std::span<const double> value,
                             double weight) {
  const int width = static_cast<int>(row.size());
  STILLPOINT_CHECK(width <= normal_.rows() && first >= 0 && first + width <= normal_.cols());
  for (int j = 0; j < width; ++j) {
    const double weighted = weight * row[static_cast<std::size_t>(j)];
    if (weighted == 0.0) continue;
    for (int i = j; i < width; ++i) normal_(i - j, first + j) += weighted * row[static_cast<std::size_t>(i)];
    for (std::size_t c = 0; c < value.size(); ++c)
      rhs_(first + j, static_cast<Eigen::Index>(c)) += weighted * value[c];
  }
}

Eigen::MatrixXd BandedLeastSquares::solve() const {
  const Eigen::Index count = normal_.cols(), band = normal_.rows();
  Eigen::MatrixXd factor = normal_;
  Eigen::MatrixXd x = rhs_;
  for (Eigen::Index j = 0; j < count; ++j) {
    STILLPOINT_CHECK(factor(0, j) > 0.0);
    const Eigen::Index below = std::min(band - 1, count - 1 - j);
    factor.col(j).head(below + 1) /= std::sqrt(factor(0, j));
    for (Eigen::Index k = 1; k <= below; ++k) {
      factor.col(j + k).head(below - k + 1) -= factor(k, j) * factor.col(j).segment(k, below - k + 1);
    }
    x.row(j) /= factor(0, j);
    for (Eigen::Index k = 1; k <= below; ++k) x.row(j + k) -= factor(k, j) * x.row(j);
  }
  for (Eigen::Index j = count - 1; j >= 0; --j) {
    const Eigen::Index below = std::min(band - 1, count - 1 - j);
    for (Eigen::Index k = 1; k <= below; ++k) x.row(j) -= factor(k, j) * x.row(j + k);
    x.row(j) /= factor(0, j);
  }
  return x;
}

}  // namespace stillpoint::synth
