// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/profile_table.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

using std::chrono::milliseconds;

TEST(ProfileRows, SeparatePerCallAndPerFrameStatistics) {
  TimingSamples samples;
  samples.add(Module::kWindowSolve, {.ns = 12'000'000, .calls = 3});
  samples.add(Module::kWindowSolve, {.ns = 2'000'000, .calls = 1});
  const std::vector<ProfileRow> rows = profile_rows(samples, 10.0);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].module, Module::kWindowSolve);
  EXPECT_DOUBLE_EQ(rows[0].per_call.mean, 3.5);   // 14 ms in 4 calls
  EXPECT_DOUBLE_EQ(rows[0].per_frame.mean, 7.0);  // 14 ms in 2 frames
  EXPECT_DOUBLE_EQ(rows[0].per_frame.p99, 11.9);  // 2 + 0.99 * (12 - 2)
  EXPECT_DOUBLE_EQ(rows[0].per_frame.max, 12.0);
  EXPECT_EQ(rows[0].frames_over, 1);  // 12 ms
}

TEST(DeadlineMisses, UseTheSumForOneThreadAndTheSlowestStageForSeveral) {
  ModuleTimings quick;  // 10 ms together
  quick.add(Module::kTrackingThread, milliseconds(4));
  quick.add(Module::kOptimizationThread, milliseconds(6));
  ModuleTimings crowded = quick;  // 25 ms together, at most 15 ms
  crowded.add(Module::kObjectDetection, milliseconds(15));
  ModuleTimings slow;  // 21 ms
  slow.add(Module::kOptimizationThread, milliseconds(21));
  const DeadlineMisses misses = deadline_misses({quick, crowded, slow}, 20.0);
  EXPECT_EQ(misses.frames, 3);
  EXPECT_EQ(misses.one_thread, 2);
  EXPECT_EQ(misses.thread_per_stage, 1);
  ASSERT_TRUE(misses.whole_frame.has_value());
  EXPECT_DOUBLE_EQ(misses.whole_frame->median, 21.0);  // of 10, 25 and 21
}

}  // namespace
}  // namespace stillpoint::bench
