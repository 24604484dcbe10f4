// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/odometry_run.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // [ns]

TEST(TimingStatistics, AreComputedPerCallForModules) {
  TimingSamples samples;
  samples.add(Module::kFeatureTracking, {.ns = 2 * kMillisecond, .calls = 1});
  samples.add(Module::kFeatureTracking, {.ns = 12 * kMillisecond, .calls = 3});
  const TimingStatistics statistics = samples.statistics(Module::kFeatureTracking).value();
  EXPECT_DOUBLE_EQ(statistics.mean, 3.5);    // 14 ms in 4 calls
  EXPECT_DOUBLE_EQ(statistics.median, 3.0);  // of 2 ms and 12 / 3 ms
  EXPECT_DOUBLE_EQ(statistics.p95, 3.9);     // 2 + 0.95 * (4 - 2)
  EXPECT_DOUBLE_EQ(statistics.max, 4.0);
  EXPECT_EQ(statistics.calls, 4);
}

TEST(TimingStatistics, AreComputedPerFrameForThreads) {
  TimingSamples samples;
  samples.add(Module::kTrackingThread, {.ns = 2 * kMillisecond, .calls = 2});
  samples.add(Module::kTrackingThread, {.ns = 4 * kMillisecond, .calls = 1});
  const TimingStatistics statistics = samples.statistics(Module::kTrackingThread).value();
  EXPECT_DOUBLE_EQ(statistics.mean, 3.0);  // 6 ms in 2 frames
  EXPECT_DOUBLE_EQ(statistics.max, 4.0);
}

TEST(TimingStatistics, AreMissingForAModuleWithoutCalls) {
  TimingSamples samples;
  samples.add(Module::kObjectDetection, {.ns = 0, .calls = 0});
  EXPECT_FALSE(samples.statistics(Module::kObjectDetection).has_value());
}

}  // namespace
}  // namespace stillpoint::bench
