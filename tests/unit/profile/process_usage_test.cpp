// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/process_usage.h"

#include <unistd.h>

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

TEST(ThreadStat, NamesMayContainSpacesAndParentheses) {
  // proc(5): utime is field 14, stime field 15.
  const ThreadUsage usage =
      parse_thread_stat("4711 (a (b) c) R 1 2 3 4 5 6 7 8 9 10 250 50 13 14 20 0 3 0 99", 100.0);
  EXPECT_EQ(usage.name, "a (b) c");
  EXPECT_DOUBLE_EQ(usage.user_s, 2.5);
  EXPECT_DOUBLE_EQ(usage.system_s, 0.5);
}

TEST(ThreadStat, RejectsTruncatedText) {
  EXPECT_THROW(static_cast<void>(parse_thread_stat("4711 (name) R 1 2 3", 100.0)), InputError);
  EXPECT_THROW(static_cast<void>(parse_thread_stat("4711", 100.0)), InputError);
}

TEST(ProcessAge, IsShortInATest) {
  EXPECT_GE(process_age_s(), 0.0);
  EXPECT_LT(process_age_s(), 3600.0);
}

TEST(ThreadUsages, ContainTheCallingThread) { EXPECT_TRUE(thread_usages().contains(gettid())); }

TEST(ProcessUsage, IsTheDifferenceOfTwoReadings) {
  const ProcessUsage before{
      .user_s = 1.0, .voluntary_switches = 3, .minor_faults = 10, .peak_memory_bytes = 100};
  const ProcessUsage after{
      .user_s = 3.5, .voluntary_switches = 4, .minor_faults = 30, .peak_memory_bytes = 400};
  const ProcessUsage between = usage_between(before, after);
  EXPECT_DOUBLE_EQ(between.user_s, 2.5);
  EXPECT_EQ(between.voluntary_switches, 1);
  EXPECT_EQ(between.minor_faults, 20);
  EXPECT_EQ(between.peak_memory_bytes, 400);
}

}  // namespace
}  // namespace stillpoint::bench
