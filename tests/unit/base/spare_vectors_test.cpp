// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/spare_vectors.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(SpareVectors, GiveBackWhatTheyWereGivenEmptied) {
  SpareVectors<int> spare;
  EXPECT_TRUE(spare.take().empty());
  std::vector<int> used = {1, 2, 3};
  const int* const memory = used.data();
  spare.give(std::move(used));
  const std::vector<int> taken = spare.take();
  EXPECT_TRUE(taken.empty());
  EXPECT_EQ(taken.data(), memory);
}

TEST(SpareVectors, DoNotCollectWhatHasNoMemory) {
  SpareVectors<int> spare;
  spare.give({1});
  spare.give({});
  EXPECT_GT(spare.take().capacity(), 0u);
}

}  // namespace
}  // namespace stillpoint
