// SPDX-License-Identifier: BSD-3-Clause
/// Feedback from the optimization stage to the tracking stage.
#pragma once

#include <cstdint>
#include <vector>

#include "core/backend/state_prediction.h"

namespace stillpoint {

struct Feedback {
  MotionState motion;                     ///< for the motion prediction of the tracker
  std::vector<std::int64_t> dynamic_ids;  ///< features currently labeled dynamic, ascending
};

}  // namespace stillpoint
