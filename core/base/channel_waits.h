// SPDX-License-Identifier: BSD-3-Clause
/// Number and duration of blocking waits at a channel.
#pragma once

#include <cstdint>
#include <string>

namespace stillpoint {

struct WaitTime {
  std::int64_t ns = 0;
  std::int64_t waits = 0;  ///< calls that blocked; calls that could proceed at once are not counted
};

struct ChannelWaits {
  std::string channel;
  WaitTime for_items;  ///< consumers, channel empty
  WaitTime for_room;   ///< producers, channel full
};

}  // namespace stillpoint
