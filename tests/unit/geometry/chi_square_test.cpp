// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/geometry/covariance.h"

namespace stillpoint {
namespace {

/// Quantiles of NIST/SEMATECH 2012, Sec. 1.3.6.7.4, to three decimals.
TEST(ChiSquareTail, IsThatOfTables) {
  EXPECT_NEAR(chi_square_tail(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_tail(10.828, 1), 0.001, 1e-6);
  EXPECT_NEAR(chi_square_tail(13.816, 2), 0.001, 1e-6);
  EXPECT_NEAR(chi_square_tail(7.815, 3), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_tail(18.467, 4), 0.001, 1e-6);
  EXPECT_NEAR(chi_square_tail(22.458, 6), 0.001, 1e-6);
}

TEST(ChiSquareTail, IsOneAtZero) {
  for (const int n : {1, 2, 3, 6}) EXPECT_EQ(chi_square_tail(0.0, n), 1.0) << n;
}

}  // namespace
}  // namespace stillpoint
