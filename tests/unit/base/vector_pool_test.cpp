// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/vector_pool.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(VectorPool, AcquireReturnsAReleasedVectorEmptyWithItsCapacity) {
  VectorPool<int> pool;
  EXPECT_TRUE(pool.acquire().empty());
  std::vector<int> used = {1, 2, 3};
  const int* const data = used.data();
  pool.release(std::move(used));
  const std::vector<int> acquired = pool.acquire();
  EXPECT_TRUE(acquired.empty());
  EXPECT_EQ(acquired.data(), data);
}

TEST(VectorPool, DiscardsVectorsWithoutCapacity) {
  VectorPool<int> pool;
  pool.release({1});
  pool.release({});
  EXPECT_GT(pool.acquire().capacity(), 0u);
}

}  // namespace
}  // namespace stillpoint
