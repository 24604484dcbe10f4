// SPDX-License-Identifier: BSD-3-Clause
// Decompositions against their definitions: products with the matrix that was decomposed.
#include "core/geometry/decompositions.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

template <int N>
void expect_solution() {
  for (int seed = 1; seed <= 10; ++seed) {
    std::srand(static_cast<unsigned>(seed));
    const SquareMatrix<N> root = SquareMatrix<N>::Random();
    const SquareMatrix<N> A = root * root.transpose();
    const Eigen::Matrix<double, N, 2> b = Eigen::Matrix<double, N, 2>::Random();
    EXPECT_LT((A * solve_symmetric(A, b) - b).norm(), 1e-8) << N << " rows, seed " << seed;
    const SquareMatrix<N> W = inverse_root(A);
    EXPECT_LT((W * A * W.transpose() - SquareMatrix<N>::Identity()).norm(), 1e-8) << N << " rows";
    const Eigen::Matrix<double, 2, N> J = Eigen::Matrix<double, 2, N>::Random();
    EXPECT_LT((propagate(J, A) - J * A * J.transpose()).norm(), 1e-14) << N << " columns, seed " << seed;
  }
}

TEST(Decompositions, SolutionsRootsAndProductsSatisfyTheirEquations) {
  expect_solution<3>();
  expect_solution<4>();
  expect_solution<6>();
  expect_solution<7>();
}

TEST(Decompositions, OfAMatrixWithoutRankTheSolutionIsZeroWhereItIsOpen) {
  const Eigen::Matrix3d A = Eigen::Vector3d(2.0, 4.0, 0.0).asDiagonal();
  EXPECT_EQ(solve_symmetric(A, Eigen::Vector3d(2.0, 2.0, 0.0)), Eigen::Vector3d(1.0, 0.5, 0.0));
}

TEST(Decompositions, EigenvaluesIncreaseAndBelongToTheirRotatedDiagonal) {
  const Eigen::Matrix3d R = exp_so3(Eigen::Vector3d(0.3, -0.7, 1.1)).toRotationMatrix();
  const Eigen::Vector3d expected(-1.0, 2.0, 5.0);
  const Eigen::Matrix3d A = R * Eigen::Vector3d(5.0, -1.0, 2.0).asDiagonal() * R.transpose();
  EXPECT_LT((eigenvalues(A) - expected).norm(), 1e-12);

  const Eigen::Matrix2d turned = Eigen::Rotation2Dd(0.4).toRotationMatrix();
  const Eigen::Matrix2d B = turned * Eigen::Vector2d(3.0, 0.0).asDiagonal() * turned.transpose();
  EXPECT_LT((eigenvalues(B) - Eigen::Vector2d(0.0, 3.0)).norm(), 1e-12);
}

TEST(Decompositions, ClosestRotationIsFoundFromPointsAndFromPointsInAPlane) {
  const Eigen::Matrix3d R = exp_so3(Eigen::Vector3d(-2.0, 0.5, 0.4)).toRotationMatrix();
  for (const double height : {1.0, 0.0}) {
    Eigen::Matrix<double, 3, 4> b;
    b << 1.0, -0.5, 0.0, 0.3, 0.2, 1.0, -1.0, 0.0, height, 0.0, -height, 0.5 * height;
    const ClosestRotation found = closest_rotation(R * b * b.transpose());
    EXPECT_LT((found.R - R).norm(), 1e-12) << "height " << height;
  }
}

TEST(Decompositions, ClosestRotationOfAReflectionIsARotationWithASmallerTrace) {
  const Eigen::Matrix3d mirror = Eigen::Vector3d(3.0, 2.0, -1.0).asDiagonal();
  const ClosestRotation found = closest_rotation(mirror);
  EXPECT_NEAR(found.R.determinant(), 1.0, 1e-12);
  EXPECT_NEAR(found.singular.sum(), (found.R.transpose() * mirror).trace(), 1e-12);
  EXPECT_NEAR(found.singular.sum(), 4.0, 1e-12);
}

}  // namespace
}  // namespace stillpoint
