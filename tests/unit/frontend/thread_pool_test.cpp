// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/thread_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace stillpoint {
namespace {

TEST(ThreadPool, CallsEveryIndexOnceJobAfterJob) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    std::vector<int> calls(50, 0);
    for (int job = 0; job < 20; ++job) {
      pool.for_each_index(calls.size(), [&](std::size_t i) { ++calls[i]; });
    }
    EXPECT_EQ(calls, std::vector<int>(50, 20)) << threads << " threads";
  }
}

TEST(ThreadPool, AcceptsAnEmptyJob) {
  ThreadPool pool(2);
  pool.for_each_index(0, [](std::size_t) { FAIL() << "called for an empty job"; });
}

TEST(ThreadPool, RethrowsAnExceptionAndRemainsUsable) {
  ThreadPool pool(2);
  const auto fail_at_three = [](std::size_t i) {
    if (i == 3) throw std::runtime_error("three");
  };
  EXPECT_THROW(pool.for_each_index(10, fail_at_three), std::runtime_error);
  std::vector<int> calls(10, 0);
  pool.for_each_index(calls.size(), [&](std::size_t i) { ++calls[i]; });
  EXPECT_EQ(std::count(calls.begin(), calls.end(), 1), 10);
}

}  // namespace
}  // namespace stillpoint
