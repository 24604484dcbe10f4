// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/bias_monitor.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr std::int64_t kInterval_ns = 50'000'000;  // 20 Hz

/// Frame from which the estimate has settled, of 100; -1 if it has not.
int settled_from(OffsetSettling& settling, double change_per_frame_s, int moving_frames) {
  double offset_s = 0.0;
  for (int i = 0; i < 100; ++i) {
    if (settling.update({i * kInterval_ns}, offset_s)) return i;
    if (i < moving_frames) offset_s += change_per_frame_s;
  }
  return -1;
}

TEST(OffsetSettling, AConstantEstimateHasSettledAfterHalfASecond) {
  OffsetSettling settling;
  EXPECT_EQ(settled_from(settling, 0.0, 0), 10);
}

/// 1 ms per frame until frame 20: over 0.5 s it changed by less than 1.5 ms from frame 29 on, when the frames
/// 19 and 20 are 1 ms apart.
TEST(OffsetSettling, AMovingEstimateSettlesWhenItHasArrived) {
  OffsetSettling settling;
  EXPECT_EQ(settled_from(settling, 0.001, 20), 29);
}

TEST(OffsetSettling, EndsAfterThreeSeconds) {
  OffsetSettling settling;
  EXPECT_EQ(settled_from(settling, 0.001, 100), 60);
}

TEST(OffsetSettling, LastsUntilTheNextStart) {
  OffsetSettling settling;
  ASSERT_EQ(settled_from(settling, 0.0, 0), 10);
  EXPECT_TRUE(settling.update({11 * kInterval_ns}, 0.1));
  settling.reset();
  EXPECT_FALSE(settling.update({12 * kInterval_ns}, 0.1));
}

}  // namespace
}  // namespace stillpoint
