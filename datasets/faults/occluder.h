// SPDX-License-Identifier: BSD-3-Clause
/// A person directly in front of the camera: the trunk fills a part of the image at its full height.
#pragma once

#include <cstdint>

#include "core/types/frame.h"

namespace stillpoint::datasets {

/// Which person, and when.
struct OccluderPhase {
  std::uint64_t seed = 1;  ///< of the clothes and of the swaying
  std::size_t frame = 0;   ///< position of the frame in the sequence; the trunk sways with it
};

/// Paints a trunk at 0.45 m over gray, color and depth. Its clothes are those of rendered people.
/// @param fraction of the image that it covers, in [0, 1]
[[nodiscard]] Frame with_occluder(Frame frame, double fraction, const OccluderPhase& phase);

}  // namespace stillpoint::datasets
