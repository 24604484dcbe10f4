// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/reusable_matrix.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace stillpoint {
namespace {

using DynamicMatrix = ReusableMatrix<Eigen::MatrixXd>;

TEST(ReusableMatrix, AssignmentResizesWithoutReallocation) {
  DynamicMatrix matrix = Eigen::MatrixXd::Constant(4, 5, 1.0);
  const double* const data = matrix.data();
  matrix = Eigen::MatrixXd::Identity(2, 3);
  EXPECT_EQ(matrix.eval(), Eigen::MatrixXd::Identity(2, 3));
  matrix.resize(5, 4);
  EXPECT_EQ(matrix.data(), data);
  EXPECT_EQ(matrix.rows(), 5);
}

TEST(ReusableMatrix, HasTheAlignmentOfEigenMatrices) {
  std::vector<std::unique_ptr<char[]>> between;
  for (std::size_t size = 8; size < 200; size += 16) {
    between.push_back(std::make_unique<char[]>(size));
    const DynamicMatrix matrix = Eigen::MatrixXd::Constant(3, 3, 1.0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(matrix.data()) % EIGEN_MAX_ALIGN_BYTES, 0u);
  }
}

TEST(ReusableMatrix, CopiesAreIndependent) {
  DynamicMatrix first = Eigen::MatrixXd::Constant(2, 2, 1.0);
  DynamicMatrix second = first;
  first(0, 0) = 7.0;
  EXPECT_EQ(second(0, 0), 1.0);
  second = first;
  first(0, 0) = 8.0;
  EXPECT_EQ(second(0, 0), 7.0);
}

TEST(ReusableMatrix, MoveTransfersTheBuffer) {
  DynamicMatrix first = Eigen::MatrixXd::Constant(3, 2, 5.0);
  const double* const data = first.data();
  DynamicMatrix second = std::move(first);
  EXPECT_EQ(second.data(), data);
  EXPECT_EQ(second.eval(), Eigen::MatrixXd::Constant(3, 2, 5.0));
  std::swap(first, second);
  EXPECT_EQ(first.data(), data);
  EXPECT_EQ(second.size(), 0);
}

TEST(ReusableMatrix, WorksForVectors) {
  ReusableVector vector = Eigen::VectorXd::LinSpaced(3, 1.0, 3.0);  // 1, 2, 3
  vector = ReusableVector(vector.tail(2));
  EXPECT_EQ(vector.size(), 2);
  EXPECT_EQ(vector.sum(), 5.0);
}

}  // namespace
}  // namespace stillpoint
