// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/frame_prefetcher.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "core/base/error.h"
#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

Frame frame_of(std::size_t index) {
  Frame frame;
  frame.id = static_cast<std::int64_t>(index);
  return frame;
}

TEST(FramePrefetcher, ReturnsFramesInOrder) {
  FramePrefetcher prefetcher(frame_of, 20, {.frames = 3});
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(prefetcher.take(i).id, static_cast<std::int64_t>(i));
  EXPECT_EQ(prefetcher.decoded().size(), 20u);
}

TEST(FramePrefetcher, ReturnsFramesInOrderFromSeveralThreads) {
  std::mutex mutex;
  std::condition_variable arrived;
  std::set<std::thread::id> threads;
  // Both threads must decode at the same time: the first two frames wait for each other.
  const auto load = [&](std::size_t index) {
    std::unique_lock lock(mutex);
    threads.insert(std::this_thread::get_id());
    arrived.notify_all();
    if (index < 2) arrived.wait(lock, [&] { return threads.size() == 2; });
    return frame_of(index);
  };
  FramePrefetcher prefetcher(load, 50, {.frames = 4, .threads = 2});
  for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(prefetcher.take(i).id, static_cast<std::int64_t>(i));
  EXPECT_EQ(threads.size(), 2u);
}

TEST(FramePrefetcher, DecodesAtMostTheGivenFramesAhead) {
  std::atomic<std::size_t> started = 0;
  const auto load = [&](std::size_t index) {
    started = std::max<std::size_t>(started, index + 1);
    return frame_of(index);
  };
  FramePrefetcher prefetcher(load, 50, {.frames = 3, .threads = 2});
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_LE(started, i + 3);  // frames 0 ... i - 1 were taken
    static_cast<void>(prefetcher.take(i));
  }
}

TEST(FramePrefetcher, DecodesOnTheCallingThreadWithoutReadAhead) {
  std::set<std::thread::id> threads;
  const auto load = [&](std::size_t index) {
    threads.insert(std::this_thread::get_id());
    return frame_of(index);
  };
  FramePrefetcher prefetcher(load, 20, {.frames = 0});
  EXPECT_EQ(prefetcher.take(2).id, 2);
  EXPECT_EQ(prefetcher.take(5).id, 5);
  EXPECT_EQ(prefetcher.decoded().size(), 2u);  // skipped frames are not decoded
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(FramePrefetcher, DropsSkippedFrames) {
  FramePrefetcher prefetcher(frame_of, 20, {.frames = 3});
  EXPECT_EQ(prefetcher.take(7).id, 7);
  EXPECT_EQ(prefetcher.take(19).id, 19);
}

TEST(FramePrefetcher, RethrowsADecodingErrorAndContinues) {
  const auto load = [](std::size_t index) {
    if (index == 1) throw InputError("1.png", "is truncated");
    return frame_of(index);
  };
  FramePrefetcher prefetcher(load, 3);
  EXPECT_EQ(prefetcher.take(0).id, 0);
  expect_input_error([&] { static_cast<void>(prefetcher.take(1)); }, {"1.png: is truncated"});
  EXPECT_EQ(prefetcher.take(2).id, 2);
}

TEST(FramePrefetcher, CanBeDestroyedWithFramesLeft) {
  FramePrefetcher prefetcher(frame_of, 1000, {.frames = 2});
  EXPECT_EQ(prefetcher.take(0).id, 0);
}

TEST(FramePrefetcher, RejectsPastAndOutOfRangeIndices) {
  FramePrefetcher prefetcher(frame_of, 3);
  static_cast<void>(prefetcher.take(1));
  EXPECT_THROW(static_cast<void>(prefetcher.take(1)), std::logic_error);
  EXPECT_THROW(static_cast<void>(prefetcher.take(3)), std::logic_error);
}

}  // namespace
}  // namespace stillpoint::bench
