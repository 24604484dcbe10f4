// SPDX-License-Identifier: BSD-3-Clause
/// When frames reach the odometry: later than their exposure, in another order, or twice.
#pragma once

#include <cstddef>

#include "core/base/timestamp.h"

namespace stillpoint {

struct FrameArrival {
  std::size_t index = 0;  ///< position of the frame in the sequence
  Timestamp t;            ///< not earlier than the timestamp of the frame
};

}  // namespace stillpoint
