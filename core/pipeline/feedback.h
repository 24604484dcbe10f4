// SPDX-License-Identifier: BSD-3-Clause
/// What the optimisation tells the tracking of the pictures that follow.
#pragma once

#include <cstdint>
#include <vector>

#include "core/backend/state_prediction.h"

namespace stillpoint {

struct Feedback {
  MotionKnowledge motion;
  std::vector<std::int64_t>
      moving;  ///< features that the newest verdicts keep out of the estimate, rising ids
};

}  // namespace stillpoint
