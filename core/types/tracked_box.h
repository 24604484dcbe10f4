// SPDX-License-Identifier: BSD-3-Clause
/// Bounding box of an object that is followed over several frames. Paper Sec. III-D.
#pragma once

#include <cstdint>
#include <string>

#include "core/types/detection.h"

namespace stillpoint {

/// Box of an object in the current frame.
struct TrackedBox {
  std::int64_t id = 0;  ///< object id, unique within a run
  std::string class_name;
  Box box;                   ///< detected, or predicted and grown [px]; without the margin of the mask
  bool compensated = false;  ///< predicted: not detected in this frame
};

}  // namespace stillpoint
