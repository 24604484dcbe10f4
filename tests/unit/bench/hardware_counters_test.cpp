// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/hardware_counters.h"

#include <cerrno>

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(HardwareCounters, CountOrSayWhyNot) {
  const HardwareCounters counters;
  volatile double sum = 0.0;
  for (int i = 0; i < 100'000; ++i) sum = sum + i;
  EXPECT_NE(counters.counts().empty(), counters.reason().empty());
  for (const HardwareCount& counter : counters.counts()) {
    // A loop of so many passes cannot take fewer instructions.
    if (counter.name == "instructions") {
      EXPECT_GT(counter.count, 100'000);
    }
  }
}

TEST(HardwareCounters, TellWhatAUserCanDo) {
  EXPECT_NE(counters_missing(EACCES).find("perf_event_paranoid"), std::string::npos);
  EXPECT_NE(counters_missing(ENOENT).find("virtual machines"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
