// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/imu_buffer.h"

#include <limits>

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// gyro x = milliseconds, accel y = -milliseconds: linear, so that interpolated values are known.
ImuSample ramp(double ms) {
  return {.t = from_seconds(ms * 1e-3), .gyro_b = {ms, 0.0, 0.0}, .accel_b = {0.0, -ms, 0.0}};
}
ImuBuffer filled(std::initializer_list<double> stamps_ms) {
  ImuBuffer buffer(0.05);
  for (const double ms : stamps_ms) buffer.add(ramp(ms));
  return buffer;
}
Timestamp at_ms(double ms) { return from_seconds(ms * 1e-3); }
std::vector<double> milliseconds(const std::vector<ImuSample>& samples) {
  std::vector<double> values;
  for (const ImuSample& sample : samples) {
    EXPECT_NEAR(sample.gyro_b.x(), static_cast<double>(sample.t.ns) / kMs, 1e-9);
    EXPECT_NEAR(sample.accel_b.y(), -static_cast<double>(sample.t.ns) / kMs, 1e-9);
    values.push_back(static_cast<double>(sample.t.ns) / kMs);
  }
  return values;
}
using Stamps = std::vector<double>;

TEST(ImuBuffer, InterpolatesBothEndsOfAnInterval) {
  ImuBuffer buffer = filled({0, 10, 20, 30, 40});
  EXPECT_EQ(milliseconds(buffer.samples_between(at_ms(5), at_ms(32))), (Stamps{5, 10, 20, 30, 32}));
}

TEST(ImuBuffer, IncludesSamplesAtTheEnds) {
  ImuBuffer buffer = filled({0, 10, 20, 30, 40});
  EXPECT_EQ(milliseconds(buffer.samples_between(at_ms(10), at_ms(30))), (Stamps{10, 20, 30}));
  EXPECT_EQ(milliseconds(buffer.samples_between(at_ms(0), at_ms(40))), (Stamps{0, 10, 20, 30, 40}));
}

TEST(ImuBuffer, InterpolatesBetweenTwoSamples) {
  ImuBuffer buffer = filled({0, 10});
  EXPECT_EQ(milliseconds(buffer.samples_between(at_ms(2), at_ms(7))), (Stamps{2, 7}));
}

TEST(ImuBuffer, ReturnsNothingIfTheIntervalIsNotCovered) {
  ImuBuffer buffer = filled({10, 20, 30});
  EXPECT_TRUE(buffer.samples_between(at_ms(5), at_ms(20)).empty());
  EXPECT_TRUE(buffer.samples_between(at_ms(15), at_ms(31)).empty());
  EXPECT_TRUE(buffer.samples_between(at_ms(20), at_ms(20)).empty());
  EXPECT_TRUE(ImuBuffer().samples_between(at_ms(0), at_ms(1)).empty());
}

TEST(ImuBuffer, DropsAndCountsBadSamples) {
  ImuBuffer buffer = filled({0, 10});
  ImuSample not_a_number = ramp(15);
  not_a_number.accel_b.z() = std::numeric_limits<double>::quiet_NaN();
  buffer.add(not_a_number);
  buffer.add(ramp(10));  // repeated
  buffer.add(ramp(5));   // out of order
  buffer.add(ramp(20));
  EXPECT_EQ(buffer.health().rejected_samples, 3);
  EXPECT_EQ(milliseconds(buffer.samples_between(at_ms(0), at_ms(20))), (Stamps{0, 10, 20}));
}

TEST(ImuBuffer, CountsAGapOnlyOnce) {
  ImuBuffer buffer = filled({0, 10, 110, 120, 190});  // gaps of 100 and 70 ms, limit 50
  EXPECT_EQ(buffer.samples_between(at_ms(0), at_ms(50)).size(), 3u);
  EXPECT_EQ(buffer.samples_between(at_ms(50), at_ms(115)).size(), 3u);
  EXPECT_EQ(buffer.health().gaps, 1);
  EXPECT_EQ(buffer.samples_between(at_ms(115), at_ms(190)).size(), 3u);
  EXPECT_EQ(buffer.health().gaps, 2);
}

/// An interval between two images is shorter than a gap that it lies in.
TEST(ImuBuffer, AGapIsInEachIntervalThatItTouches) {
  ImuBuffer buffer(0.05);
  for (int i = 0; i < 100; ++i) buffer.add(ramp(5.0 * i + (i < 50 ? 0.0 : 60.0)));  // 65 ms after 245
  for (const double begin : {220.0, 245.0, 270.0, 300.0})
    EXPECT_TRUE(buffer.gap_in(at_ms(begin), at_ms(begin + 33.0)).is_long);
  EXPECT_FALSE(buffer.gap_in(at_ms(212), at_ms(245)).is_long);
  EXPECT_FALSE(buffer.gap_in(at_ms(310), at_ms(343)).is_long);
}

/// Of 20 ms in samples of 200 Hz, as of a clock that jumps; three missing samples are none.
TEST(ImuBuffer, AStepOfMoreThanFourAndAHalfPeriodsMayBeAJump) {
  for (const int missing : {3, 4}) {
    ImuBuffer buffer(0.05);
    for (int i = 0; i < 100; ++i) buffer.add(ramp(5.0 * (i < 50 ? i : i + missing)));
    const ImuGap gap = buffer.gap_in(at_ms(233), at_ms(267));
    EXPECT_EQ(gap.may_be_jump, missing == 4);
    EXPECT_FALSE(gap.is_long);
  }
}

TEST(ImuBuffer, SamplesOfALowRateAndShortBuffersHaveNoGap) {
  const ImuBuffer slow = filled({0, 100, 200, 300, 400});
  EXPECT_FALSE(slow.gap_in(at_ms(120), at_ms(153)).is_long);
  EXPECT_FALSE(slow.gap_in(at_ms(-50), at_ms(50)).is_long);
  EXPECT_FALSE(filled({}).gap_in(at_ms(0), at_ms(33)).is_long);
  EXPECT_FALSE(filled({10}).gap_in(at_ms(0), at_ms(33)).may_be_jump);
}

TEST(ImuBuffer, ExtrapolatesTheNewestSampleToTheEnd) {
  ImuBuffer buffer = filled({0, 10, 20});
  const std::vector<ImuSample> cut = buffer.samples_up_to(at_ms(5), at_ms(60));
  ASSERT_EQ(cut.size(), 4u);  // 5, 10, 20, and the sample at 20 repeated at 60
  EXPECT_EQ(cut.back().t, at_ms(60));
  EXPECT_EQ(cut.back().gyro_b.x(), 20.0);
  EXPECT_EQ(cut.front().gyro_b.x(), 5.0);
}

TEST(ImuBuffer, ExtrapolatesAnIntervalAfterTheNewestSample) {
  ImuBuffer buffer = filled({0, 10, 20});
  const std::vector<ImuSample> cut = buffer.samples_up_to(at_ms(25), at_ms(30));
  ASSERT_EQ(cut.size(), 2u);
  EXPECT_EQ(cut.front().t, at_ms(25));
  EXPECT_EQ(cut.front().gyro_b.x(), 20.0);
}

TEST(ImuBuffer, DoesNotExtrapolateBeyondTheMaximumGap) {
  ImuBuffer buffer = filled({0, 10, 20});
  EXPECT_TRUE(buffer.samples_up_to(at_ms(5), at_ms(71)).empty());  // 51 ms after the newest, limit 50
}

TEST(ImuBuffer, SamplesUpToEqualsSamplesBetweenInsideTheBuffer) {
  ImuBuffer buffer = filled({0, 10, 20});
  EXPECT_EQ(milliseconds(buffer.samples_up_to(at_ms(5), at_ms(20))), (Stamps{5, 10, 20}));
}

TEST(ImuBuffer, AveragesTheSamplesAroundATime) {
  const ImuBuffer buffer = filled({0, 10, 20, 30, 40});
  EXPECT_NEAR(buffer.mean_around(at_ms(20), 0.015)->gyro_b.x(), 20.0, 1e-9);
  EXPECT_NEAR(buffer.mean_around(at_ms(35), 0.02)->gyro_b.x(), 35.0, 1e-9);   // 30 and 40: 5 ms are covered
  EXPECT_NEAR(buffer.mean_around(at_ms(24), 0.001)->gyro_b.x(), 24.0, 1e-9);  // interpolated
  EXPECT_FALSE(buffer.mean_around(at_ms(41), 0.02));
  EXPECT_FALSE(ImuBuffer().mean_around(at_ms(0), 0.02));
}

TEST(ImuBuffer, DropsOnlySamplesThatAreNoLongerNeeded) {
  ImuBuffer buffer = filled({0, 10, 20, 30});
  buffer.drop_before(at_ms(15));
  EXPECT_EQ(milliseconds(buffer.samples_between(at_ms(15), at_ms(30))), (Stamps{15, 20, 30}));
  EXPECT_TRUE(buffer.samples_between(at_ms(5), at_ms(30)).empty());  // the sample at 0 ms was dropped
}

}  // namespace
}  // namespace stillpoint
