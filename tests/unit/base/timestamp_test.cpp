// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/timestamp.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(Timestamp, DurationsAreExactToTheNanosecondFarFromTheEpoch) {
  const Timestamp t{1'403'715'888'379'060'000};
  EXPECT_EQ(seconds_between(t, Timestamp{t.ns + 1}), 1e-9);
  EXPECT_EQ(seconds_between(Timestamp{t.ns + 500'000'000}, t), -0.5);
}

TEST(Timestamp, DurationsBeyond64BitsOfNanosecondsDoNotOverflow) {
  // 9e18 - (-9e18) ns = 1.8e19 ns, more than 2^63 = 9.2e18.
  EXPECT_DOUBLE_EQ(
      seconds_between(Timestamp{-9'000'000'000'000'000'000}, Timestamp{9'000'000'000'000'000'000}), 1.8e10);
}

TEST(Timestamp, AfterRoundsToTheNearestNanosecond) {
  EXPECT_EQ(after(Timestamp{10}, 1.6e-9).ns, 12);
  EXPECT_EQ(after(Timestamp{10}, -1.6e-9).ns, 8);
}

}  // namespace
}  // namespace stillpoint
