// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/skyline_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace stillpoint {
namespace {

/// Positive definite skyline matrix of 15 rows; tiles start at columns 0, 0, 6, 3, 6.
const std::vector<int> kFirst = {0, 0, 6, 3, 6};

RowMajorMatrix skyline_matrix() {
  RowMajorMatrix S = RowMajorMatrix::Zero(15, 15);
  for (int row = 0; row < 15; ++row) {
    for (int column = kFirst[static_cast<std::size_t>(row / kTile)]; column <= row; ++column) {
      S(row, column) = column == row ? 20.0 + row : 1.0 / (1 + row - column);
    }
  }
  return S;
}

TEST(SkylineCholesky, SolvesTheDenseSystem) {
  RowMajorMatrix S = skyline_matrix();
  const Eigen::MatrixXd full = S.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(15, -1.0, 2.0);
  Eigen::VectorXd x = b;
  ASSERT_TRUE(skyline_factorize(kFirst, S));
  skyline_solve(kFirst, S, x);
  EXPECT_LT((full * x - b).norm(), 1e-13);
}

TEST(SkylineCholesky, DoesNotAccessEntriesOutsideTheProfile) {
  RowMajorMatrix S = skyline_matrix();
  ASSERT_TRUE(skyline_factorize(kFirst, S));
  EXPECT_TRUE(S.block(6, 0, 3, 6).isZero(0.0));
  EXPECT_TRUE(S.block(9, 0, 3, 3).isZero(0.0));
}

TEST(SkylineCholesky, RejectsAMatrixThatIsNotPositiveDefinite) {
  RowMajorMatrix S = skyline_matrix();
  S(7, 7) = -1.0;
  EXPECT_FALSE(skyline_factorize(kFirst, S));
}

}  // namespace
}  // namespace stillpoint
