// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/process_usage.h"

#include <cerrno>

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

TEST(HardwareCounters, EitherCountOrGiveAReason) {
  const HardwareCounters counters;
  volatile double sum = 0.0;
  for (int i = 0; i < 100'000; ++i) sum = sum + i;
  EXPECT_NE(counters.counts().empty(), counters.reason().empty());
  for (const HardwareCount& counter : counters.counts()) {
    // Lower bound: one instruction per iteration.
    if (counter.name == "instructions") {
      EXPECT_GT(counter.count, 100'000);
    }
  }
}

TEST(HardwareCounters, ErrorsContainAdvice) {
  EXPECT_NE(describe_counter_error(EACCES).find("perf_event_paranoid"), std::string::npos);
  EXPECT_NE(describe_counter_error(ENOENT).find("virtual machines"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint::bench
