// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/module_timings.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(ModuleTimings, RecordTheSpansOfScopedTimers) {
  ModuleTimings timings;
  {
    const ScopedTimer outer(timings, Module::kStateOptimization);
    const ScopedTimer inner(timings, Module::kWindowSolve, ScopedTimer::Kind::kPart);
  }
  ASSERT_EQ(timings.spans().size(), 2U);
  const ModuleSpan& inner = timings.spans()[0];
  const ModuleSpan& outer = timings.spans()[1];
  EXPECT_EQ(inner.module, Module::kWindowSolve);
  EXPECT_LE(outer.start, inner.start);
  EXPECT_GE(outer.start + outer.elapsed, inner.start + inner.elapsed);
  EXPECT_EQ(timings[Module::kStateOptimization].ns, outer.elapsed.count());
  EXPECT_EQ(timings[Module::kWindowSolve].calls, 0);
}

TEST(ModuleTimings, AddIncludesTheSpansOfTheOther) {
  ModuleTimings timings;
  ModuleTimings other;
  other.add({.module = Module::kFeatureMask, .elapsed = std::chrono::nanoseconds(7)}, 1);
  timings.add(other);
  timings.add(other);
  EXPECT_EQ(timings.spans().size(), 2U);
  EXPECT_EQ(timings[Module::kFeatureMask].ns, 14);
  timings.drop_spans();
  EXPECT_TRUE(timings.spans().empty());
  EXPECT_EQ(timings[Module::kFeatureMask].ns, 14);
}

}  // namespace
}  // namespace stillpoint
