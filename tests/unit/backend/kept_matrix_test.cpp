// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/kept_matrix.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace stillpoint {
namespace {

using Kept = KeptMatrix<Eigen::MatrixXd>;

TEST(KeptMatrix, TakesTheSizeOfWhatIsAssignedInTheMemoryThatItHas) {
  Kept kept = Eigen::MatrixXd::Constant(4, 5, 1.0);
  const double* const memory = kept.data();
  kept = Eigen::MatrixXd::Identity(2, 3);
  EXPECT_EQ(kept.eval(), Eigen::MatrixXd::Identity(2, 3));
  kept.resize(5, 4);
  EXPECT_EQ(kept.data(), memory);
  EXPECT_EQ(kept.rows(), 5);
}

TEST(KeptMatrix, IsAlignedAsEigensOwnWhateverTheHeap) {
  std::vector<std::unique_ptr<char[]>> between;
  for (std::size_t size = 8; size < 200; size += 16) {
    between.push_back(std::make_unique<char[]>(size));
    const Kept kept = Eigen::MatrixXd::Constant(3, 3, 1.0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(kept.data()) % EIGEN_MAX_ALIGN_BYTES, 0u);
  }
}

TEST(KeptMatrix, CopiesAreOfTheirOwn) {
  Kept first = Eigen::MatrixXd::Constant(2, 2, 1.0);
  Kept second = first;
  first(0, 0) = 7.0;
  EXPECT_EQ(second(0, 0), 1.0);
  second = first;
  first(0, 0) = 8.0;
  EXPECT_EQ(second(0, 0), 7.0);
}

TEST(KeptMatrix, MovesWithItsMemory) {
  Kept first = Eigen::MatrixXd::Constant(3, 2, 5.0);
  const double* const memory = first.data();
  Kept second = std::move(first);
  EXPECT_EQ(second.data(), memory);
  EXPECT_EQ(second.eval(), Eigen::MatrixXd::Constant(3, 2, 5.0));
  std::swap(first, second);
  EXPECT_EQ(first.data(), memory);
  EXPECT_EQ(second.size(), 0);
}

TEST(KeptMatrix, IsAVectorToo) {
  KeptVector vector = Eigen::VectorXd::LinSpaced(3, 1.0, 3.0);  // 1, 2, 3
  vector = KeptVector(vector.tail(2));
  EXPECT_EQ(vector.size(), 2);
  EXPECT_EQ(vector.sum(), 5.0);
}

}  // namespace
}  // namespace stillpoint
