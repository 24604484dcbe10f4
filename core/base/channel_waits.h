// SPDX-License-Identifier: BSD-3-Clause
/// How often and how long threads waited at a channel.
#pragma once

#include <cstdint>
#include <string>

namespace stillpoint {

struct WaitTime {
  std::int64_t ns = 0;
  std::int64_t waits = 0;  ///< those who found what they wanted did not wait
};

struct ChannelWaits {
  std::string channel;
  WaitTime for_items;  ///< of those who took
  WaitTime for_room;   ///< of those who put
};

}  // namespace stillpoint
