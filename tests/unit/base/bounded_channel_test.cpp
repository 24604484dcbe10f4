// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/bounded_channel.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace stillpoint {
namespace {

TEST(BoundedChannel, TransfersAllItemsInOrderBetweenThreads) {
  constexpr int kItems = 10000;
  BoundedChannel<int> channel(3);
  const std::jthread producer([&channel] {
    for (int i = 0; i < kItems; ++i) channel.push(i);
    channel.close();
  });
  for (int i = 0; i < kItems; ++i) ASSERT_EQ(channel.pop(), i);
  EXPECT_EQ(channel.pop(), std::nullopt);
}

TEST(BoundedChannel, PushDroppingOldestDropsTheOldestItemWhenFull) {
  BoundedChannel<int> channel(2);
  EXPECT_EQ(channel.push_dropping_oldest(1), std::nullopt);
  EXPECT_EQ(channel.push_dropping_oldest(2), std::nullopt);
  EXPECT_EQ(channel.push_dropping_oldest(3), 1);
  EXPECT_EQ(channel.pop(), 2);
  EXPECT_EQ(channel.pop(), 3);
}

TEST(BoundedChannel, RejectsPushesAfterCloseButPopsRemainingItems) {
  BoundedChannel<int> channel(2);
  channel.push(1);
  channel.close();
  EXPECT_FALSE(channel.push(2));
  EXPECT_EQ(channel.push_dropping_oldest(2), std::nullopt);
  EXPECT_EQ(channel.pop(), 1);
  EXPECT_EQ(channel.pop(), std::nullopt);
}

TEST(BoundedChannel, CloseWakesBlockedProducersAndConsumers) {
  BoundedChannel<int> full(1), empty(1);
  full.push(1);
  bool pushed = true;
  std::optional<int> popped = 1;
  {
    const std::jthread pusher([&] { pushed = full.push(2); });
    const std::jthread popper([&] { popped = empty.pop(); });
    full.close();
    empty.close();
  }
  EXPECT_FALSE(pushed);
  EXPECT_EQ(popped, std::nullopt);
}

TEST(BoundedChannel, PopForReturnsNothingAfterTheTimeout) {
  BoundedChannel<int> channel(1);
  EXPECT_EQ(channel.pop_for(std::chrono::milliseconds(1)), std::nullopt);
  channel.push(7);
  EXPECT_EQ(channel.pop_for(std::chrono::nanoseconds(0)), 7);
}

}  // namespace
}  // namespace stillpoint
